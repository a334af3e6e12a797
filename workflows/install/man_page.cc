#include "workflows/install/man_page.h"

#include <ostream>

#include <fmt/format.h>

#include "workflows/options/help_text.h"
#include "workflows/run/version.h"

namespace velamap {
namespace {

// Escapes text so that roff shows it unchanged: hyphens can be pasted into a shell, and no line is
// a request.
std::string Roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    const bool begins_line = escaped.empty() || escaped.back() == '\n';
    if (begins_line && (c == '.' || c == '\'')) escaped += "\\&";
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

void BeginPage(const std::string& name, const std::string& description, std::ostream& out) {
  out << fmt::format(".TH {} 1 \"\" \"velamap {}\" \"User Commands\"\n", Roff(name), kVersion);
  out << fmt::format(".SH NAME\n{} \\- {}\n", Roff(name), Roff(description));
}

void WriteExample(const std::string& text, std::ostream& out) {
  out << fmt::format(".SH EXAMPLE\n.nf\n{}\n.fi\n", Roff(text));
}

void WriteOption(const ShownOption& option, std::ostream& out) {
  out << fmt::format(".TP\n\\fB\\-\\-{}\\fR \\fI{}\\fR", Roff(option.name), Roff(option.unit));
  if (!option.default_text.empty()) out << fmt::format(" (={})", Roff(option.default_text));
  out << fmt::format("\n{}\n", Roff(option.description));
}

}  // namespace

void WriteManPage(const CommandSyntax& syntax, std::ostream& out) {
  BeginPage("velamap-" + syntax.name, syntax.description, out);
  out << fmt::format(".SH SYNOPSIS\n.B velamap {}\n[\\fIoption value\\fR ...]\n",
                     Roff(syntax.name));
  out << ".SH OPTIONS\nWhere an option is left out, it has the value after the equals sign in "
         "parentheses.\n";
  for (const ShownGroup& group : ShownOptions(syntax, HelpLength::kAll)) {
    out << fmt::format(".SS {}\n", Roff(group.title));
    for (const ShownOption& option : group.options) WriteOption(option, out);
  }
  WriteExample("velamap " + syntax.name + " " + syntax.example, out);
  out << ".SH SEE ALSO\n.BR velamap (1)\n";
}

void WriteProgramManPage(const std::vector<CommandGroup>& groups, std::ostream& out) {
  BeginPage("velamap", kProgramDescription, out);
  out << ".SH SYNOPSIS\n.B velamap\n.I command\n[\\fIoption value\\fR ...]\n"
         ".SH DESCRIPTION\nMeasures the shape of a surface that carries printed ArUco markers, "
         "from photographs or a video of one camera. Results go to standard output as \"key: "
         "value\", "
         "everything else to standard error.\n.SH COMMANDS\n";
  for (const CommandGroup& group : groups) {
    out << fmt::format(".SS {}\n", Roff(group.title));
    for (const Command& command : group.commands) {
      out << fmt::format(".TP\n.BR velamap\\-{} (1)\n{}\n", Roff(command.syntax.name),
                         Roff(command.syntax.description));
    }
  }
  out << ".SH EXIT STATUS\n"
         ".TP\n0\nThe result is there and is complete.\n"
         ".TP\n1\nThe data do not support a result; standard error says why.\n"
         ".TP\n2\nBad input or option.\n"
         ".TP\n3\nCOLMAP is absent, failed, or its result is implausible.\n"
         ".TP\n4\nA bug in velamap.\n";
  WriteExample(
      "velamap automatic_reconstructor --image_path clip.mp4 --camera_path camera.yml \\\n"
      "    --layout_path layout.yml --workspace_path result",
      out);
  out << ".SH SEE ALSO\n.BR colmap (1)\n";
}

}  // namespace velamap
