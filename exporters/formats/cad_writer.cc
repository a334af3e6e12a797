#include "exporters/formats/cad_writer.h"

#include <algorithm>
#include <ostream>
#include <vector>

#include <fmt/chrono.h>
#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <GeomToStep_MakeBSplineCurveWithKnots.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESBasic_Name.hxx>
#include <IGESControl_Writer.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_IGESWriter.hxx>
#include <IGESSelect_WorkLibrary.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Writer.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <StepGeom_BSplineCurveWithKnots.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepGeom_GeometricRepresentationItem.hxx>
#include <StepShape_GeometricSet.hxx>
#include <StepShape_GeometricSetSelect.hxx>
#include <StepShape_HArray1OfGeometricSetSelect.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <XSControl_WorkSession.hxx>

#include "exporters/formats/ascii.h"
#include "exporters/formats/cad_library.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "importer/text/output_date.h"

namespace velamap {
namespace {

constexpr double kToleranceMm = 1e-5;
// After the first digit: as many as Open CASCADE has room for (24 characters), 1e-6 mm at 5000 km.
constexpr int kIgesDecimals = 15;

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

TColStd_Array1OfReal Reals(const std::vector<double>& values) {
  TColStd_Array1OfReal array(1, static_cast<int>(values.size()));
  std::copy(values.begin(), values.end(), array.begin());
  return array;
}

TColStd_Array1OfInteger Integers(const std::vector<int>& values) {
  TColStd_Array1OfInteger array(1, static_cast<int>(values.size()));
  std::copy(values.begin(), values.end(), array.begin());
  return array;
}

gp_Pnt PointInMm(const Eigen::Vector3d& x_m) {
  return {kMmPerM * x_m.x(), kMmPerM * x_m.y(), kMmPerM * x_m.z()};
}

Handle(Geom_BSplineCurve) MakeCurve(const CadCurve& curve) {
  TColgp_Array1OfPnt poles(1, static_cast<int>(curve.poles_in_shape_m.cols()));
  for (int i = 0; i < poles.Size(); ++i) {
    poles.SetValue(i + 1, PointInMm(curve.poles_in_shape_m.col(i)));
  }
  const Knots knots = CountKnots(curve.knots);
  return new Geom_BSplineCurve(poles, Reals(knots.values), Integers(knots.multiplicities),
                               curve.degree);
}

TopoDS_Edge MakeEdge(const CadCurve& curve) {
  BRepBuilderAPI_MakeEdge edge(MakeCurve(curve));
  VELAMAP_CHECK(edge.IsDone());
  return edge.Edge();
}

TopoDS_Face MakeFace(const SplineSurface& surface) {
  const int num_u = surface.NumPolesU(), num_v = surface.NumPolesV();
  TColgp_Array2OfPnt poles(1, num_u, 1, num_v);
  for (int i = 0; i < num_u; ++i) {
    for (int j = 0; j < num_v; ++j) {
      poles.SetValue(i + 1, j + 1, PointInMm(surface.poles_in_shape_m.row(i * num_v + j)));
    }
  }
  const Knots u = CountKnots(surface.knots_u), v = CountKnots(surface.knots_v);
  const Handle(Geom_BSplineSurface) spline =
      new Geom_BSplineSurface(poles, Reals(u.values), Reals(v.values), Integers(u.multiplicities),
                              Integers(v.multiplicities), surface.degree_u, surface.degree_v);
  BRepBuilderAPI_MakeFace face(spline, kToleranceMm);
  VELAMAP_CHECK(face.IsDone());
  return face.Face();
}

Handle(TCollection_HAsciiString) Text(const std::string& text) {
  return new TCollection_HAsciiString(text.c_str());
}

// Puts the other curves and the points into the set of the first curve, and names all.
void CompleteCurveSet(const CadExtras& extras, const Handle(StepData_StepModel) & model,
                      const Handle(StepShape_GeometricSet) & set) {
  VELAMAP_CHECK(set->NbElements() == 1);
  const int num_curves = static_cast<int>(extras.curves.size());
  const int num_points = static_cast<int>(extras.points.size());
  const Handle(StepShape_HArray1OfGeometricSetSelect) elements =
      new StepShape_HArray1OfGeometricSetSelect(1, num_curves + num_points);
  int element_idx = 1;
  const auto add = [&](const Handle(StepGeom_GeometricRepresentationItem) & item,
                       const std::string& name) {
    item->SetName(Text(Ascii(name)));
    model->AddWithRefs(item);
    StepShape_GeometricSetSelect element;
    element.SetValue(item);
    elements->SetValue(element_idx++, element);
  };
  add(set->ElementsValue(1).Curve(), extras.curves.front().name);
  for (int i = 1; i < num_curves; ++i) {
    const GeomToStep_MakeBSplineCurveWithKnots curve(MakeCurve(extras.curves[i]));
    VELAMAP_CHECK(curve.IsDone());
    add(curve.Value(), extras.curves[i].name);
  }
  for (const CadPoint& marker : extras.points) {
    const gp_Pnt x = PointInMm(marker.x_in_shape_m);
    const Handle(StepGeom_CartesianPoint) point = new StepGeom_CartesianPoint;
    point->Init3D(Text(""), x.X(), x.Y(), x.Z());
    add(point, marker.name);
  }
  set->SetElements(elements);
}

// Adds a product with the curves and points. Open CASCADE writes one set for each edge, so it gets
// only the first curve.
void TransferExtras(const CadExtras& extras, STEPControl_Writer* writer) {
  if (extras.curves.empty()) return;
  const TopoDS_Edge edge = MakeEdge(extras.curves.front());
  VELAMAP_CHECK(writer->Transfer(edge, STEPControl_GeometricCurveSet) == IFSelect_RetDone);
  const Handle(StepData_StepModel) model = writer->Model();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto set = Handle(StepShape_GeometricSet)::DownCast(model->Value(i));
    if (set.IsNull()) continue;
    CompleteCurveSet(extras, model, set);
    return;
  }
  VELAMAP_CHECK(false);
}

void DescribeStepFile(const std::string& name, const Handle(StepData_StepModel) & model) {
  APIHeaderSection_MakeHeader header(model);
  header.SetName(Text(name));
  header.SetTimeStamp(Text(fmt::format("{:%Y-%m-%dT%H:%M:%S}", OutputDate())));
  header.SetAuthorValue(1, Text(""));
  header.SetOrganizationValue(1, Text(""));
  header.SetOriginatingSystem(Text("velamap"));
  header.SetDescriptionValue(1, Text("surface through markers, unit mm"));
  // Open CASCADE's own setting would append a number that grows with every file.
  std::string product_name = name;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto product = Handle(StepBasic_Product)::DownCast(model->Value(i));
    if (product.IsNull()) continue;
    product->SetId(Text(product_name));
    product->SetName(Text(product_name));
    product_name = name + ", sections and markers";
  }
}

void DescribeIges(const std::string& name, const std::string& file_name,
                  IGESControl_Writer* writer) {
  IGESData_GlobalSection header = writer->Model()->GlobalSection();
  header.SetSendName(Text(name));
  header.SetReceiveName(Text(name));
  header.SetFileName(Text(file_name.empty() ? name + ".igs" : file_name));
  header.SetSystemId(Text("velamap"));
  header.SetInterfaceVersion(Text("velamap"));
  header.SetAuthorName(Text("velamap"));
  header.SetCompanyName(Text(""));
  const std::string date = fmt::format("{:%Y%m%d.%H%M%S}", OutputDate());
  header.SetDate(Text(date));
  header.SetLastChangeDate(Text(date));
  writer->Model()->SetGlobalSection(header);
}

// Adds a shape under a name: as the label, which has room for eight characters, and as a property,
// which has room for all.
void AddNamed(const TopoDS_Shape& shape, const std::string& name, IGESControl_Writer* writer) {
  constexpr std::size_t kLabelSize = 8;
  // A shape's own entity comes before those that it refers to.
  const int entity_idx = writer->Model()->NbEntities() + 1;
  VELAMAP_CHECK(writer->AddShape(shape));
  VELAMAP_CHECK(entity_idx <= writer->Model()->NbEntities());
  const Handle(IGESData_IGESEntity) entity = writer->Model()->Entity(entity_idx);
  entity->SetLabel(Text(name.substr(0, kLabelSize)));
  const Handle(IGESBasic_Name) property = new IGESBasic_Name;
  property->Init(1, Text(name));
  writer->AddEntity(property);
  entity->AddProperty(property);
}

}  // namespace

void WriteStep(const SplineSurface& surface, const std::string& name, std::ostream& out,
               const CadExtras& extras) {
  const CadSession session;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.unit", "MM");
  STEPControl_Writer writer;
  VELAMAP_CHECK(writer.Transfer(MakeFace(surface), STEPControl_AsIs) == IFSelect_RetDone);
  TransferExtras(extras, &writer);
  DescribeStepFile(Ascii(name), writer.Model());
  StepData_StepWriter text(writer.Model());
  text.SendModel(Handle(StepData_Protocol)::DownCast(writer.WS()->Protocol()));
  // The owner of the stream reports its failure.
  VELAMAP_CHECK(text.Print(out) || !out);
}

void WriteIges(const SplineSurface& surface, const std::string& name, std::ostream& out,
               const CadExtras& extras) {
  const CadSession session;
  IGESControl_Writer writer("MM", 0);  // 0: trimmed surfaces, which every program reads
  AddNamed(MakeFace(surface), Ascii(name), &writer);
  for (const CadCurve& curve : extras.curves) {
    AddNamed(MakeEdge(curve), Ascii(curve.name), &writer);
  }
  for (const CadPoint& point : extras.points) {
    AddNamed(BRepBuilderAPI_MakeVertex(PointInMm(point.x_in_shape_m)).Vertex(), Ascii(point.name),
             &writer);
  }
  writer.ComputeModel();
  DescribeIges(Ascii(name), Ascii(extras.iges_file_name), &writer);
  IGESData_IGESWriter text(writer.Model());
  // By default ten digits are written, which are tenths of a millimetre far from the origin.
  text.FloatWriter().SetDefaults(kIgesDecimals);
  // Open CASCADE removes zeros only from numbers of at most 16 characters, and spoils longer ones.
  text.FloatWriter().SetZeroSuppress(Standard_False);
  text.SendModel(IGESSelect_WorkLibrary::DefineProtocol());
  VELAMAP_CHECK(text.Print(out) || !out);
}

}  // namespace velamap
