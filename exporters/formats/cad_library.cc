#include "exporters/formats/cad_library.h"

#include <IGESControl_Controller.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Controller.hxx>

namespace velamap {
namespace {

std::mutex cad_mutex;

}  // namespace

CadSession::CadSession() : lock_(cad_mutex) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Controller::Init();
  IGESControl_Controller::Init();
  // Shapes in memory are in mm, whatever the unit of the file.
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
}

}  // namespace velamap
