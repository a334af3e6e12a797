#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "tests/exporters/example_model.h"
#include "tests/exporters/exported_files.h"
#include "tests/exporters/golden_file.h"
#include "tests/support/export_shape.h"

namespace velamap {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::UnorderedElementsAre;

std::string ErrorOf(const ShapeExporterOptions& options) {
  try {
    ExportShape(ExampleModel(), ExampleLayout(), options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ShapeExporter, EitherFolderCanBeLeftOut) {
  const TempDir dir;
  ShapeExporterOptions options;
  options.shape_output_path = (dir / "a" / "shape").string() + "/";
  ExportShape(ExampleModel(), ExampleLayout(), options);
  EXPECT_THAT(FilesIn(dir.path()), UnorderedElementsAre("a"));
  EXPECT_THAT(FilesIn(dir / "a"), UnorderedElementsAre("shape"));
  options.shape_output_path.clear();
  options.model_output_path = dir / "model";
  ExportShape(ExampleModel(), ExampleLayout(), options);
  EXPECT_THAT(FilesIn(dir.path()), UnorderedElementsAre("a", "model"));
}

TEST(ShapeExporter, FoldersOfOursAreReplacedAsAWhole) {
  const TempDir dir;
  for (const char* name : {"shape", "0"}) {
    AtomicFolder folder(dir / name);
    std::ofstream(folder.TemporaryPath() / "old.csv") << "old";
    folder.Commit();
  }
  ExportShape(ExampleModel(), ExampleLayout(), OptionsIn(dir));
  EXPECT_THAT(ReadBytes(dir / "shape" / "scale.csv"), StartsWith("marker_id,"));
  for (const char* name : {"shape", "0"}) EXPECT_EQ(FilesIn(dir / name).count("old.csv"), 0u);
  EXPECT_THAT(FilesIn(dir.path()), UnorderedElementsAre("shape", "0"));  // nothing temporary
}

TEST(ShapeExporter, FoldersOfOthersStayAsTheyAre) {
  for (const char* folder : {"shape", "0"}) {
    const TempDir dir;
    fs::create_directories(dir / folder);
    std::ofstream(dir / folder / "thesis.tex") << "precious";
    EXPECT_THAT(ErrorOf(OptionsIn(dir)), StartsWith((dir / folder).string() + ": "));
    EXPECT_THAT(ErrorOf(OptionsIn(dir)), HasSubstr("holds thesis.tex"));
    EXPECT_THAT(ErrorOf(OptionsIn(dir)), HasSubstr("choose another folder"));
    EXPECT_THAT(FilesIn(dir.path()), UnorderedElementsAre(folder));
    EXPECT_THAT(BytesIn(dir / folder),
                UnorderedElementsAre(std::make_pair("thesis.tex", "precious")));
  }
}

TEST(ShapeExporter, AFolderWithTheNameOfAFileIsNotOurs) {
  const TempDir dir;
  fs::create_directories(dir / "shape" / "shape.csv");
  std::ofstream(dir / "shape" / "shape.csv" / "notes.txt") << "precious";
  EXPECT_THAT(ErrorOf(OptionsIn(dir)), HasSubstr("shape.csv: the output folder holds notes.txt"));
}

TEST(ShapeExporter, OutputThatIsAFileOrBelowOneIsNamed) {
  const TempDir dir;
  std::ofstream(dir / "file") << "precious";
  for (const std::string& bad : {(dir / "file").string(), (dir / "file" / "below").string()}) {
    for (const bool is_model : {false, true}) {
      ShapeExporterOptions options = OptionsIn(dir);
      (is_model ? options.model_output_path : options.shape_output_path) = bad;
      // A file in the place of a folder is the one that is named.
      EXPECT_THAT(ErrorOf(options), StartsWith((dir / "file").string() + ": "));
      EXPECT_THAT(FilesIn(dir.path()), UnorderedElementsAre("file"));
    }
  }
  EXPECT_EQ(ReadBytes(dir / "file"), "precious");
}

TEST(ShapeExporter, OneFolderInsideTheOtherIsRefused) {
  const TempDir dir;
  const struct {
    std::string model, shape;
  } cases[] = {{"out", "out"}, {"out", "out/"}, {"out", "x/../out/shape"}, {"out/0", "out"}};
  for (const auto& c : cases) {
    ShapeExporterOptions options;
    options.model_output_path = dir / c.model;
    options.shape_output_path = dir / c.shape;
    EXPECT_THAT(ErrorOf(options), AnyOf(HasSubstr("is also the folder of the model"),
                                        HasSubstr("is replaced as a whole and must not hold")));
    EXPECT_TRUE(FilesIn(dir.path()).empty());
  }
}

}  // namespace
}  // namespace velamap
