// Options and files of the commands around the main job: what they print, plan, calibrate, check,
// export and compare.

#include "tests/bad_input/sandbox.h"

namespace velamap {
namespace {

std::vector<BadInput> Prints() {
  const std::string call = "marker_generator --output_path @/new --marker_length 0.1 ";
  const std::string sail = call + "--arrangement sail --Sail.luff 6 --Sail.foot 3 --Sail.leech ";
  return {{"MoreMarkersThanCodes", call + "--num_markers 251", 2, "has 250 codes"},
          {"MarkersThatAreNotPrinted", call + "--num_markers 5 --ids 77", 2,
           "--ids: marker 77 is not among"},
          {"NoListOfMarkers", call + "--num_markers 5 --ids ,", 2, "--ids: ','"},
          {"ASailThatIsNoTriangle", sail + "3", 2, "is not a triangle"},
          {"ASailWithoutRoom", sail + "6 --Sail.lines 50", 2, "--Sail.lines"},
          {"PaperOfNoSize", call + "--num_markers 1 --Sheet.paper 0x0", 2, "--Sheet.paper: '0x0'"},
          {"AMarkerLargerThanThePaper",
           "marker_generator --output_path @/new --num_markers 1 --marker_length 9", 2,
           "is too small for marker 0"},
          {"ALayoutAndItsReplacementPrinted",
           "marker_generator --output_path @/new --layout_path @/layout.yml --num_markers 3", 2,
           "--layout_path: it cannot be combined"},
          {"TooManyCodes", call + "--num_markers 3 --CustomDictionary.bits 9", 2,
           "--CustomDictionary.bits: 9 is out of range"},
          {"PrintsOverPhotographs",
           "marker_generator --num_markers 2 --marker_length 0.1 --output_path @/images", 2,
           "holds 1.png"},
          {"PrintsOverAFile",
           "marker_generator --num_markers 2 --marker_length 0.1 --output_path @/layout.yml", 2,
           "layout.yml: cannot be written"}};
}

// Options that the choice of markers leaves without effect.
std::vector<BadInput> PlansWithUnusedOptions() {
  const std::string lines =
      "shoot_planner --field_of_view 90 --layout_path @/lines.yml --Sail.luff 6 --Sail.foot 3 "
      "--Sail.leech 6.2 ";
  const std::string grid =
      "shoot_planner --field_of_view 90 --marker_length 0.1 --Plan.surface grid ";
  const auto write_lines =
      Write("lines.yml",
            "dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n  sail:\n    horizontal:\n"
            "      - {name: h1, markers: [0, 1, 2, 3]}\n      - {name: h2, markers: [4, 5, 6]}\n");
  std::vector<BadInput> cases;
  for (const std::string name : {"hull_markers", "Sail.lines", "Sail.markers_per_line"}) {
    cases.push_back({"APlanOfLinesWithMarkersOfItsOwn" + std::to_string(cases.size()),
                     lines + "--" + name + " 3", 2, "--" + name + ": it would change nothing",
                     write_lines});
  }
  cases.push_back(
      {"AGridWithCamber", grid + "--Plan.camber 0.1", 2, "--Plan.camber: it would change nothing"});
  cases.push_back(
      {"AGridWithTwist", grid + "--Plan.twist 10", 2, "--Plan.twist: it would change nothing"});
  return cases;
}

std::vector<BadInput> Plans() {
  const std::string sail =
      "shoot_planner --marker_length 0.1 --Sail.luff 6 --Sail.foot 3 --Sail.leech 6.2 ";
  const std::string call = sail + "--field_of_view 90 ";
  return {
      {"APlanWithoutACamera", sail, 2, "--camera_path: missing"},
      {"APlanWithTwoCameras", call + "--camera_path @/camera.yml", 2,
       "--field_of_view: the calibration says"},
      {"APlanWithTwoSpeeds", call + "--Plan.speed 1 --Plan.speed_knots 2", 2,
       "--Plan.speed_knots: --Plan.speed gives"},
      {"APlanFromFarOff", call + "--Plan.distance 10000", 2, "--Plan.distance: from 10000 m"},
      {"AStraightLensOf170Degrees", sail + "--field_of_view 170", 2, "give --lens wide"},
      {"APlanOfALayoutWithoutLines",
       "shoot_planner --field_of_view 90 --layout_path @/layout.yml --Sail.luff 6 --Sail.foot 3 "
       "--Sail.leech 6.2",
       2, "the layout has no horizontal lines"},
      {"APlanOfAShapeAndASail", call + "--shape_path @/workspace/shape", 2,
       "--Sail.foot: it would change nothing"},
      {"APlanOfAShapeThatIsNone",
       "shoot_planner --marker_length 0.1 --field_of_view 90 --shape_path @/layout.yml", 2,
       "layout.yml:1: expected the header"},
      {"APlanOverPhotographs", call + "--output_path @/images", 2, "holds 1.png"}};
}

std::vector<BadInput> BoardsAndClips() {
  const std::string board = "camera_calibrator --image_path @/images --report_path @/new.html ";
  const std::string clip = "clip_checker --image_path @/clip.avi ";
  return {{"ABoardIntoAFolder", board + "--output_path @/grey", 2,
           "grey is a folder; give the name of a file"},
          {"ABoardOverAPhotograph", board + "--output_path @/images/1.png", 2,
           "is also the --image_path"},
          {"ACameraModelThatIsNone", board + "--output_path @/new.yml --camera_model ROUND", 2,
           "--camera_model: 'ROUND' is unknown"},
          {"AClipIntoAFolder", clip + "--output_path @/workspace", 2, "workspace is a folder"},
          {"AProposedLayoutIntoAFolder", clip + "--proposed_layout_path @/workspace", 2,
           "workspace is a folder"},
          {"AProposedLayoutOverTheGivenOne",
           clip + "--layout_path @/layout.yml --proposed_layout_path @/layout.yml", 2,
           "is also the --layout_path"},
          {"AProposedLayoutOverOneOfTheUser", clip + "--proposed_layout_path @/mine.yml", 2,
           "mine.yml would be replaced, but velamap did not write it",
           Write("mine.yml", "dictionary: DICT_4X4_50\nmarker_length: 0.1\n")},
          {"AProposedLayoutOverAnEditedOne", clip + "--proposed_layout_path @/mine.yml", 2,
           "mine.yml would be replaced, but was changed after velamap wrote it",
           Write("mine.yml", "# Proposed by velamap clip_checker.\ndictionary: DICT_4X4_50\n")},
          {"AMarkedFrameThatIsNoPng", clip + "--output_path @/frame.jpg", 2,
           "frame.jpg does not end in .png"},
          {"ACalibrationOverOneOfTheUser", board + "--output_path @/mine.yml", 2,
           "mine.yml would be replaced, but velamap did not write it",
           Write("mine.yml", "%YAML:1.0\n---\nimage_width: 3\n")},
          {"AClipThatEndsBeforeItBegins", clip + "--Video.first_frame 3 --Video.last_frame 1", 2,
           "--Video.last_frame: 1 is before"},
          {"SomeFramesOfPhotographs", "clip_checker --image_path @/images --num_frames 30", 2,
           "--num_frames: it would change nothing"},
          {"PhotographsAsAVideo", "clip_checker --image_path @/images --Video.first_frame 3", 2,
           "--Video.first_frame: it would change nothing"},
          {"AClipThatBeginsAfterItsEnd", clip + "--Video.first_frame 1000", 2, "none at or after"},
          {"APlaylistInPlaceOfAClip", "clip_checker --image_path @/list.m3u8", 2, "list.m3u8",
           Write("list.m3u8",
                 "#EXTM3U\n#EXT-X-TARGETDURATION:5\n#EXTINF:5,\n/etc/passwd\n#EXT-X-ENDLIST\n")},
          {"ATextInPlaceOfAClip", "clip_checker --image_path @/notes.txt", 2,
           "notes.txt: is a text or a list of other files",
           Write("notes.txt", std::string(10000, 'a'))},
          {"AListOfClips", "clip_checker --image_path @/list.ffconcat", 2,
           "list.ffconcat: is a text or a list of other files",
           Write("list.ffconcat", "ffconcat version 1.0\nfile clip.avi\n")},
          {"AClipOfItself", "clip_checker --image_path @/list.ffconcat", 2, "list.ffconcat",
           Write("list.ffconcat", "ffconcat version 1.0\nfile list.ffconcat\n")}};
}

std::vector<BadInput> Layouts() {
  const std::string call =
      "shape_exporter --input_path @/workspace/sparse/0 --shape_path @/out --layout_path @/bad.yml";
  const std::string head = "dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n";
  const auto with = [=](const std::string& more) {
    return [=](const fs::path& dir) {
      WriteTextFile(dir / "bad.yml", ReadFileBytes(dir / "layout.yml") + more);
    };
  };
  const auto edges = [=](const std::string& text) {
    return Write("bad.yml", head +
                                "  sail:\n    horizontal:\n      - {name: h1, markers: [0, 1, 2]}\n"
                                "      - {name: h2, markers: [3, 4, 5]}\n    edges: " +
                                text + "\n");
  };
  return {{"ADistanceOfManyDigits", call, 2, "distances[0].length: 1e+300 m is not a length",
           with("distances: [{from: 0, to: 1, length: 1e300, sigma: 0.1}]\n")},
          {"ADistanceFromAMarkerToItself", call, 2, "from and to are the same point",
           with("distances: [{from: 1, to: 1, length: 0.1, sigma: 0.001}]\n")},
          {"ASecondDocument", call, 2, "bad.yml:6: a second document begins here",
           with("---\nmarker_length: 0.2\n")},
          {"TextAfterTheEndOfTheDocument", call, 2, "a second document begins here",
           with("...\n# no key\nmarker_length: 0.2\n")},
          {"AZeroByteInTheNameOfAPart", call, 2, "control characters is expected",
           Write("bad.yml", head + "  \"a\\0b\": {markers: [0, 1, 2, 3, 4, 5]}\n")},
          {"ALineBreakInTheNameOfALine", call, 2, "control characters is expected",
           Write("bad.yml", head + "  a: {horizontal: [{name: \"a\\nb\", markers: [0, 1]}]}\n")},
          {"AFrameOfAList", call, 2, "frame: '' is not a frame", with("frame: [1, 2, 3]\n")},
          {"AFrameOfOneMarker", call, 2, "three different markers",
           with("frame: {origin: 1, axis: 1, plane: 1}\n")},
          {"KnownPointsThatAreNoList", call, 2, "known_points: a list is expected",
           with("known_points: {at: 0}\n")},
          {"KnownPointWithAUnit", call, 2, "known_points[0].x: '12 mm' is not a number",
           with("known_points: [{at: 0, x: 12 mm, sigma: 0.001}]\n")},
          {"AnEdgeBelowZero", call, 2, "edges.luff: -0.1 m is out of range", edges("{luff: -0.1}")},
          {"EdgesForOtherLines", call, 2, "3 distances for 2 horizontal lines",
           edges("{luff: [0, 0, 0]}")},
          {"AnEdgeAtALineThatIsNone", call, 2, "there is no vertical line 'v1'",
           edges("{luff: {line: v1}}")},
          {"AnEdgeOfAForeignMarker", call, 2, "edges.foot.points[1]: marker 9 is not in the part",
           edges("{foot: {points: [0.4, 9]}}")},
          {"EdgesWithoutLines", call, 2, "edges of a part without horizontal lines",
           Write("bad.yml", head + "  a: {markers: [0, 1], edges: {luff: 0.1}}\n")}};
}

std::vector<BadInput> Exports() {
  const std::string call =
      "shape_exporter --marker_length 0.1 --input_path @/workspace/sparse/0 --shape_path @/out ";
  const std::string analyzed = "shape_analyzer --shape_path @/workspace/shape ";
  return {
      {"AUnitThatIsNone", call + "--unit inch", 2, "--unit: 'inch' is unknown"},
      {"APresetThatIsNone", call + "--preset thesys", 2, "--preset: 'thesys' is unknown"},
      {"HeightsWithoutLines", call + "--Section.heights 1", 2,
       "--Section.heights: it would change nothing"},
      {"ATextPlyOfNothing",
       "shape_exporter --marker_length 0.1 --input_path @/workspace/sparse/0 --output_path @/new "
       "--ascii_ply 1",
       2, "--ascii_ply: it would change nothing"},
      {"MarkersForMetashapeOfNothing",
       "shape_exporter --marker_length 0.1 --input_path @/workspace/sparse/0 --output_path @/new "
       "--metashape 1",
       2, "--metashape: it would change nothing"},
      {"ASceneForAliceVisionOfNothing",
       "shape_exporter --marker_length 0.1 --input_path @/workspace/sparse/0 --output_path @/new "
       "--alicevision 1",
       2, "--alicevision: it would change nothing"},
      {"AScaleOfAMetricModel", call + "--scale_by mean_side", 2,
       "--scale_by: it would change nothing"},
      {"AShutterWithoutFrames",
       "bundle_adjuster --backend markers --marker_length 0.1 --input_path @/workspace/sparse/0 "
       "--output_path @/new --MarkerAdjustment.rolling_shutter 0.02",
       2, "--MarkerAdjustment.rolling_shutter: it would change nothing"},
      {"AnUnknownCameraThatIsHeld",
       "bundle_adjuster --backend markers --marker_length 0.1 --input_path @/workspace/sparse/0 "
       "--output_path @/new --MarkerAdjustment.find_camera 1 --MarkerAdjustment.intrinsics_sigma "
       "0.001",
       2, "--MarkerAdjustment.intrinsics_sigma: it would change nothing"},
      {"HeightsThatAreNone", call + "--Section.heights 1,b", 2, "--Section.heights: '1,b'"},
      {"AnEdgeOfOnePoint", call + "--Surface.edges_path @/bad.csv", 2, "one point",
       Write("bad.csv", "edge,x,y,z\nluff,0,0,0\n")},
      {"AZeroByteInTheEdges", call + "--Surface.edges_path @/bad.csv", 2, "bad.csv:2: a zero byte",
       Write("bad.csv", std::string("edge,x,y,z\nluff,0\0,0,0\n", 23))},
      {"ATableIntoAFolder", analyzed + "--marker_length 0.1 --csv_path @/grey", 2,
       "grey is a folder; give the name of a file"},
      {"ATableWithTheNameOfAFolder", analyzed + "--marker_length 0.1 --csv_path @/new/", 2,
       "is a folder"},
      {"AProjectFileInAProjectFile", analyzed + "--project_path @/p.ini", 2,
       "p.ini: project_path: a project file cannot name another one",
       Write("p.ini", "project_path=q.ini\n")},
      {"AZeroByteInAProjectFile", analyzed + "--project_path @/p.ini", 2, "p.ini: a zero byte",
       Write("p.ini", std::string("marker_length=0.1\0\n", 19))},
      {"HelpWithAValue", analyzed + "--help=1", 2, "--help: unknown option; see velamap"}};
}

// Where memory is short, a sanitizer ends the reader of meshes before it can say so.
#ifdef VELAMAP_SANITIZE
constexpr const char* kTooMuchMemory = "bad.ply: its reader ended without a mesh";
#else
constexpr const char* kTooMuchMemory = "bad.ply: reading it takes more than 8192 MB of memory";
#endif

std::vector<BadInput> Comparisons() {
  const std::string call = "shape_comparer --shape_path @/workspace/shape --reference_path ";
  const std::string own = call + "@/workspace/shape ";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  return {
      {"AMeshLargerThanAllMemory", call + "@/bad.ply", 2, kTooMuchMemory,
       Write("bad.ply", ply + "0 0 0\n")},
      {"AnObjOfOtherVertices", call + "@/bad.obj", 2, "bad.obj: cannot be read",
       Write("bad.obj", "v 0 0 0\nf 1 2 3\n")},
      {"AnStlCutOff", call + "@/bad.stl", 2, "bad.stl: cannot be read",
       Write("bad.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n")},
      {"AChordOfNothing", own + "--chord_deviation 1e-9", 2, "--chord_deviation: 1e-09 is out of"},
      {"AReferenceUnitThatIsNone", own + "--reference_unit feet", 2, "--reference_unit: 'feet'"},
      {"AUnitOfAShape", own + "--reference_unit mm", 2,
       "--reference_unit: it would change nothing"},
      {"APartThatIsNone", own + "--part nope", 2, "--part: no marker of part 'nope'"},
      {"AlignedByAMarkerThatIsNone", own + "--align markers --align_markers 0,1,49", 2,
       "the shape has no marker 49"},
      {"AlignedByNoMarkers", own + "--align markers", 2, "--align_markers: missing"},
      {"ASurfaceWithoutLines", own + "--surface_path @/new.ply", 2,
       "--surface_path: needs --layout_path"},
      {"AnUncertaintyThatIsNone", own + "--uncertainty_path @/grey", 2, "holds no uncertainty.bin"},
      {"AShapeOfOtherMarkers", call + "@/bad.csv", 1, "0 marker corners in common",
       Write("bad.csv",
             "marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part\n"
             "40,1,0,0,0,,,,2,\n40,2,1,0,0,,,,2,\n40,3,1,1,0,,,,2,\n40,4,0,1,0,,,,2,\n")}};
}

// A design for the report of the main job.
std::vector<BadInput> Designs() {
  const auto write = [](const std::string& design) {
    return [design](const fs::path& dir) {
      WriteTextFile(dir / design, "no surface");
      WriteTextFile(dir / "lines.yml",
                    "dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n"
                    "  sail: {horizontal: [{name: h1, markers: [0, 1, 2, 3]}]}\n");
    };
  };
  const std::string call =
      "automatic_reconstructor --image_path @/images --camera_path @/camera.yml --layout_path "
      "@/lines.yml --backend markers --workspace_path @/new --design_path ";
  return {
      {"ADesignThatIsNotThere", call + "@/no.step", 2, "no.step", write("bad.stl")},
      {"ADesignOfALayoutWithoutLines", kRerun + " --design_path @/layout.yml", 2,
       "--design_path: it would change nothing"},
      {"AUnitWithoutADesign", kRerun + " --design_unit mm", 2,
       "--design_unit: it would change nothing"},
      {"ADesignThatIsATable", call + "@/bad.csv", 2, "bad.csv is not a surface", write("bad.csv")},
      {"ADesignThatIsNoMesh", call + "@/bad.stl", 2, "bad.stl: ", write("bad.stl")},
      {"AUnitOfADesignThatNamesItsOwn", call + "@/bad.step --design_unit mm", 2,
       "names its unit itself", write("bad.step")},
      {"ADesignInFeet", call + "@/bad.stl --design_unit ft", 2, "--design_unit: 'ft'",
       write("bad.stl")}};
}

}  // namespace

std::vector<BadInput> CommandCases() {
  std::vector<BadInput> cases = Prints();
  for (const auto& more : {Plans(), PlansWithUnusedOptions(), BoardsAndClips(), Layouts(),
                           Exports(), Comparisons(), Designs()}) {
    cases.insert(cases.end(), more.begin(), more.end());
  }
  return cases;
}

}  // namespace velamap
