// Reads the values of the keys of a layout file. All functions throw InputError that names file,
// line and key for an invalid value.

#pragma once

#include <string>
#include <vector>

#include "importer/layout/frame_choice.h"
#include "importer/layout/layout.h"
#include "importer/layout/yaml_item.h"

namespace velamap {

double ReadMetres(const YamlItem& item);

// Reads the edges of `part`, whose lines have been read already.
ClothEdges ReadEdges(const YamlItem& item, const LayoutPart& part);

// "12" is the centre of marker 12 (corner 0), "12.1" its corner 1.
void ReadMarkerPoint(const YamlItem& item, int* marker_id, int* corner);

// Throws InputError if no part of the layout names one of the markers. A layout without parts
// accepts every id.
void CheckMarkersAreNamed(const std::vector<int>& marker_ids, const Layout& layout,
                          const YamlItem& item);

// Reads what a measurement is used for: returns true for `word`, which means that it takes part in
// the result, and false for "check". The error message explains `word` by `meaning`.
bool TakesPart(const YamlItem& item, const std::string& word, const std::string& meaning);

// Reads the list of measured distances. `layout` already has its parts.
std::vector<KnownDistance> ReadDistances(const YamlItem& list, const Layout& layout);

// Reads the list of points with measured coordinates. `layout` already has its parts.
std::vector<KnownPoint> ReadKnownPoints(const YamlItem& list, const Layout& layout);

// Reads the frame of the result. `layout` already has its parts, reference part and known points.
FrameChoice ReadFrame(const YamlItem& item, const Layout& layout);

}  // namespace velamap
