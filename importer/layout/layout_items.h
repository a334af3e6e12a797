// The values of a layout file's keys. All functions throw InputError that names file, line and key.

#pragma once

#include <string>
#include <vector>

#include "importer/layout/frame_choice.h"
#include "importer/layout/layout.h"
#include "importer/layout/yaml_item.h"

namespace velamap {

int ReadMarkerId(const YamlItem& item);
double ReadMetres(const YamlItem& item);

// The edges of a part, which has its lines.
ClothEdges ReadEdges(const YamlItem& item, const LayoutPart& part);

// "12" is the centre of marker 12 (corner 0), "12.1" its corner 1.
void ReadMarkerPoint(const YamlItem& item, int* marker_id, int* corner);

// Throws for a marker that no part of the layout names. A layout without parts accepts every id.
void CheckMarkersAreNamed(const std::vector<int>& marker_ids, const Layout& layout,
                          const YamlItem& item);

// What a measurement is used for: whether it takes part in the result, which is called `word` and
// explained by `meaning`, or is only a check.
bool TakesPart(const YamlItem& item, const std::string& word, const std::string& meaning);

// The list of measured distances. `layout` already has its parts.
std::vector<KnownDistance> ReadDistances(const YamlItem& list, const Layout& layout);

// The list of points with measured coordinates. `layout` already has its parts.
std::vector<KnownPoint> ReadKnownPoints(const YamlItem& list, const Layout& layout);

// The frame of the result. `layout` already has its parts, its reference part and its known points.
FrameChoice ReadFrame(const YamlItem& item, const Layout& layout);

}  // namespace velamap
