// Removes an earlier import, so that all is imported anew.

#pragma once

#include "importer/marker_importer.h"

namespace velamap {

// Removes the database, the frames that the import has written if another video replaces them, and,
// in a workspace, its copies of photographs that have changed since. Nothing happens if there is no
// database. Throws InputError before anything is removed if the database is not one of velamap's,
// or if the new import cannot begin: images or video that cannot be opened, a picture of the user
// in the place of a frame.
void RemoveEarlierImport(const MarkerImporterOptions& options);

}  // namespace velamap
