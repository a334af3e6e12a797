// main() of the tests that read meshes.

#include <gmock/gmock.h>

#include "exporters/design/mesh_reader.h"

int main(int argc, char** argv) {
  velamap::ServeMeshReader(argc, argv);
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
