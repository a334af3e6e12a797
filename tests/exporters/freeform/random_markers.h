// Markers drawn at random on surfaces whose distance is known exactly.

#pragma once

#include <functional>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "exporters/freeform/freeform_surface.h"

namespace velamap {

// A surface with its outward side, in m.
struct TrueSurface {
  // Positive outside. Near the surface the distance from it.
  std::function<double(const Eigen::Vector3d&)> distance_m;
  // A point of it for two numbers between 0 and 1.
  std::function<Eigen::Vector3d(double, double)> point;
};

TrueSurface Sphere(double radius_m);
TrueSurface Cylinder(double radius_m, double length_m);       // open, about z
TrueSurface Torus(double radius_m, double tube_radius_m);     // about z
TrueSurface Saddle(double bend_per_m, double half_length_m);  // z = bend (x^2 - y^2)
TrueSurface Wave(double height_m, double half_length_m);      // z = height sin(2 pi x) cos(3 y)

// The derivative of the distance.
Eigen::Vector3d TrueNormal(const TrueSurface& surface, const Eigen::Vector3d& x_m);

struct RandomMarkers {
  double spacing_m = 0.0;  // no two centres are nearer
  double side_m = 0.0;
  double sigma_m = 0.0;  // noise of each coordinate of a corner
};

// As many markers as places are found for, turned at random, with ids from 0.
std::vector<FreeformMarker> DrawMarkers(const TrueSurface& surface, const RandomMarkers& random,
                                        std::mt19937* generator);

}  // namespace velamap
