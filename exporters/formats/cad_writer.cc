#include "exporters/formats/cad_writer.h"

#include <algorithm>
#include <ostream>
#include <vector>

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESControl_Writer.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Writer.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopoDS_Face.hxx>
#include <XSControl_WorkSession.hxx>

#include "exporters/formats/cad_library.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kToleranceMm = 1e-5;
// Both formats require a time stamp; a constant one keeps the bytes the same.
constexpr const char* kTimeStamp = "1970-01-01T00:00:00";

struct Knots {
  std::vector<double> values;
  std::vector<int> multiplicities;
};

Knots CountKnots(const Eigen::ArrayXd& flat_knots) {
  Knots knots;
  for (const double knot : flat_knots) {
    if (knots.values.empty() || knot > knots.values.back()) {
      knots.values.push_back(knot);
      knots.multiplicities.push_back(0);
    }
    ++knots.multiplicities.back();
  }
  return knots;
}

TopoDS_Face MakeFace(const SplineSurface& surface) {
  const int num_u = surface.NumPolesU(), num_v = surface.NumPolesV();
  TColgp_Array2OfPnt poles(1, num_u, 1, num_v);
  for (int i = 0; i < num_u; ++i) {
    for (int j = 0; j < num_v; ++j) {
      const Eigen::Vector3d x = kMmPerM * surface.poles_in_shape_m.row(i * num_v + j);
      poles.SetValue(i + 1, j + 1, gp_Pnt(x.x(), x.y(), x.z()));
    }
  }
  const Knots u = CountKnots(surface.knots_u), v = CountKnots(surface.knots_v);
  const auto reals = [](const std::vector<double>& values) {
    TColStd_Array1OfReal array(1, static_cast<int>(values.size()));
    std::copy(values.begin(), values.end(), array.begin());
    return array;
  };
  const auto integers = [](const std::vector<int>& values) {
    TColStd_Array1OfInteger array(1, static_cast<int>(values.size()));
    std::copy(values.begin(), values.end(), array.begin());
    return array;
  };
  const Handle(Geom_BSplineSurface) spline =
      new Geom_BSplineSurface(poles, reals(u.values), reals(v.values), integers(u.multiplicities),
                              integers(v.multiplicities), surface.degree_u, surface.degree_v);
  BRepBuilderAPI_MakeFace face(spline, kToleranceMm);
  VELAMAP_CHECK(face.IsDone());
  return face.Face();
}

Handle(TCollection_HAsciiString) Text(const std::string& text) {
  return new TCollection_HAsciiString(text.c_str());
}

// Replaces characters outside ASCII, which neither format allows, by underscores.
std::string Ascii(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; }, '_');
  return name.empty() ? "surface" : name;
}

void DescribeStep(const std::string& name, const Handle(StepData_StepModel) & model) {
  APIHeaderSection_MakeHeader header(model);
  header.SetName(Text(name));
  header.SetTimeStamp(Text(kTimeStamp));
  header.SetAuthorValue(1, Text(""));
  header.SetOrganizationValue(1, Text(""));
  header.SetOriginatingSystem(Text("velamap"));
  header.SetDescriptionValue(1, Text("surface through markers, unit mm"));
  // Open CASCADE's own setting would append a number that grows with every file.
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto product = Handle(StepBasic_Product)::DownCast(model->Value(i));
    if (product.IsNull()) continue;
    product->SetId(Text(name));
    product->SetName(Text(name));
  }
}

void DescribeIges(const std::string& name, IGESControl_Writer* writer) {
  IGESData_GlobalSection header = writer->Model()->GlobalSection();
  header.SetSendName(Text(name));
  header.SetReceiveName(Text(name));
  header.SetFileName(Text(name + ".iges"));
  header.SetSystemId(Text("velamap"));
  header.SetInterfaceVersion(Text("velamap"));
  header.SetAuthorName(Text("velamap"));
  header.SetCompanyName(Text(""));
  header.SetDate(Text("19700101.000000"));
  header.SetLastChangeDate(Text("19700101.000000"));
  writer->Model()->SetGlobalSection(header);
}

}  // namespace

void WriteStep(const SplineSurface& surface, const std::string& name, std::ostream& out) {
  const CadSession session;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.unit", "MM");
  STEPControl_Writer writer;
  VELAMAP_CHECK(writer.Transfer(MakeFace(surface), STEPControl_AsIs) == IFSelect_RetDone);
  DescribeStep(Ascii(name), writer.Model());
  StepData_StepWriter text(writer.Model());
  text.SendModel(Handle(StepData_Protocol)::DownCast(writer.WS()->Protocol()));
  // The owner of the stream reports its failure.
  VELAMAP_CHECK(text.Print(out) || !out);
}

void WriteIges(const SplineSurface& surface, const std::string& name, std::ostream& out) {
  const CadSession session;
  IGESControl_Writer writer("MM", 0);  // 0: trimmed surfaces, which every program reads
  VELAMAP_CHECK(writer.AddShape(MakeFace(surface)));
  writer.ComputeModel();
  DescribeIges(Ascii(name), &writer);
  VELAMAP_CHECK(writer.Write(out, Standard_False) || !out);
}

}  // namespace velamap
