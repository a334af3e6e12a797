#include "tests/exporters/formats/cad_names.h"

#include <stdexcept>

#include <BRepAdaptor_Curve.hxx>
#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <STEPControl_Reader.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_GeometricSet.hxx>
#include <StepShape_GeometricSetSelect.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include "exporters/formats/cad_library.h"

namespace velamap {
namespace {

Eigen::Vector3d PointOf(const gp_Pnt& x_mm) {
  return 1e-3 * Eigen::Vector3d(x_mm.X(), x_mm.Y(), x_mm.Z());
}

void Add(const std::string& name, const TopoDS_Shape& shape, CadNames* names) {
  if (shape.IsNull()) return;
  if (shape.ShapeType() == TopAbs_VERTEX) {
    names->points[name] = PointOf(BRep_Tool::Pnt(TopoDS::Vertex(shape)));
  }
  if (shape.ShapeType() != TopAbs_EDGE && shape.ShapeType() != TopAbs_WIRE) return;
  const TopExp_Explorer edges(shape, TopAbs_EDGE);
  const BRepAdaptor_Curve curve(TopoDS::Edge(edges.Current()));
  names->curves[name] = PointOf(curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2));
}

TopoDS_Shape ShapeOf(const Handle(Transfer_TransientProcess) & process,
                     const Handle(Standard_Transient) & entity) {
  return TransferBRep::ShapeResult(process, entity);
}

CadNames NamesInStep(const std::filesystem::path& path) {
  STEPControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("STEP");
  reader.TransferRoots();
  const auto process = reader.WS()->TransferReader()->TransientProcess();
  CadNames names;
  for (int i = 1; i <= reader.Model()->NbEntities(); ++i) {
    const auto set = Handle(StepShape_GeometricSet)::DownCast(reader.Model()->Value(i));
    for (int k = 1; !set.IsNull() && k <= set->NbElements(); ++k) {
      const auto item =
          Handle(StepRepr_RepresentationItem)::DownCast(set->ElementsValue(k).Value());
      Add(item->Name()->ToCString(), ShapeOf(process, item), &names);
    }
  }
  return names;
}

CadNames NamesInIges(const std::filesystem::path& path) {
  IGESControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("IGES");
  reader.TransferRoots();
  const auto process = reader.WS()->TransferReader()->TransientProcess();
  CadNames names;
  for (int i = 1; i <= reader.Model()->NbEntities(); ++i) {
    const auto entity = Handle(IGESData_IGESEntity)::DownCast(reader.Model()->Value(i));
    if (!entity.IsNull() && entity->HasName()) {
      Add(entity->NameValue()->ToCString(), ShapeOf(process, entity), &names);
    }
  }
  return names;
}

bool IsStep(const std::filesystem::path& path) {
  return path.extension() == ".step" || path.extension() == ".stp";
}

TopoDS_Shape FacesInStep(const std::filesystem::path& path, std::string* unit) {
  STEPControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("STEP");
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.FileUnits(lengths, angles, solid_angles);
  if (!lengths.IsEmpty()) *unit = lengths.First().ToCString();
  reader.TransferRoots();
  return reader.OneShape();
}

TopoDS_Shape FacesInIges(const std::filesystem::path& path, std::string* unit) {
  IGESControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("IGES");
  const auto name = reader.IGESModel()->GlobalSection().UnitName();
  if (!name.IsNull()) *unit = name->ToCString();
  reader.TransferRoots();
  return reader.OneShape();
}

}  // namespace

CadFaces ReadCadFaces(const std::filesystem::path& path) {
  const CadSession session;
  CadFaces result;
  const TopoDS_Shape shape = IsStep(path) ? FacesInStep(path, &result.length_unit)
                                          : FacesInIges(path, &result.length_unit);
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-6);
  result.area_m2 = 1e-6 * properties.Mass();
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, Standard_False, Standard_False);
  result.min_m = PointOf(box.CornerMin());
  result.max_m = PointOf(box.CornerMax());
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) ++result.num_faces;
  return result;
}

CadNames ReadCadNames(const std::filesystem::path& path) {
  const CadSession session;
  return IsStep(path) ? NamesInStep(path) : NamesInIges(path);
}

}  // namespace velamap
