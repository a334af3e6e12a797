// The program.

#include "exporters/design/mesh_reader.h"
#include "workflows/commands/program.h"

int main(int argc, char** argv) {
  velamap::ServeMeshReader(argc, argv);
  return velamap::Main(argc, argv);
}
