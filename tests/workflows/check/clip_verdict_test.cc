#include "workflows/check/clip_verdict.h"

#include <functional>

#include <gmock/gmock.h>

namespace velamap {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

ClipFacts GoodClip() {
  ClipFacts facts;
  facts.num_frames = 400;
  facts.num_frames_read = 40;
  facts.is_video = facts.has_layout = true;
  facts.dictionary = "DICT_4X4_50";
  for (int marker_id = 0; marker_id < 20; ++marker_id) facts.num_frames_of_id[marker_id] = 30;
  facts.side_px = ComputeStatistics({24, 30, 36});
  facts.black = 30;
  facts.white = 210;
  facts.blur_px = 0.8;
  facts.motion_px = 1.0;
  facts.precision = ClipPrecision{40, 20, 0.5, 1e-3, 40, {}, {}, {}, {}, {}};
  facts.has_camera = true;
  return facts;
}

TEST(ClipVerdict, NothingToSayOfAGoodClip) {
  const Verdict verdict = JudgeClip(GoodClip());
  EXPECT_EQ(verdict.level, ReportStatus::kGood);
  EXPECT_THAT(verdict.reasons, IsEmpty());
}

struct Spoilt {
  const char* word;
  ReportStatus level;
  std::function<void(ClipFacts*)> spoil;
};

std::vector<Spoilt> SpoiltPictures() {
  return {{"no marker is seen", ReportStatus::kBad,
           [](ClipFacts* facts) {
             *facts = {};
             facts->num_frames_read = 40;
           }},
          {"name the dictionary", ReportStatus::kBad,
           [](ClipFacts* facts) {
             facts->num_markers_found = 30;
             facts->num_markers_of_second = 20;
           }},
          {"never seen: 21-23 25", ReportStatus::kCheck,
           [](ClipFacts* facts) {
             facts->ids_never_seen = {21, 22, 23, 25};
           }},
          {"2 markers between seen ones are never found: 21-22", ReportStatus::kCheck,
           [](ClipFacts* facts) {
             facts->ids_never_seen = facts->ids_unseen_between_seen = {21, 22};
           }},
          {"12 % of the markers are overexposed", ReportStatus::kCheck,
           [](ClipFacts* facts) { facts->poor_light_share = 0.12; }},
          {"61 of 81 markers of the layout are never seen: the layout or the dictionary",
           ReportStatus::kBad,
           [](ClipFacts* facts) {
             for (int id = 20; id < 81; ++id) facts->ids_never_seen.push_back(id);
           }},
          {"25 markers are found only in the mirrored image", ReportStatus::kBad,
           [](ClipFacts* facts) {
             for (int id = 20; id < 45; ++id) facts->ids_mirrored.push_back(id);
           }},
          {"seen in fewer than 3 of 40 frames: 7", ReportStatus::kCheck,
           [](ClipFacts* facts) { facts->num_frames_of_id[7] = 2; }},
          {"not in the layout: 99", ReportStatus::kCheck,
           [](ClipFacts* facts) { facts->ids_not_in_layout = {99}; }},
          {"smaller than 9.0 px", ReportStatus::kBad,
           [](ClipFacts* facts) { facts->side_px = ComputeStatistics({9}); }},
          {"overexposed", ReportStatus::kCheck, [](ClipFacts* facts) { facts->white = 254; }},
          {"differ by 40", ReportStatus::kCheck, [](ClipFacts* facts) { facts->black = 170; }},
          {"shorter shutter", ReportStatus::kCheck, [](ClipFacts* facts) { facts->motion_px = 6; }},
          {"focus", ReportStatus::kCheck, [](ClipFacts* facts) { facts->blur_px = 2.5; }},
          {"50 % of the frames", ReportStatus::kCheck,
           [](ClipFacts* facts) { facts->num_frames_with_few_markers = 20; }},
          {"3 of 43 frames looked at are damaged", ReportStatus::kCheck,
           [](ClipFacts* facts) { facts->num_frames_damaged = 3; }}};
}

void ContradictCamera(ClipFacts* facts) {
  CalibrationEvidence& evidence = facts->precision->calibration;
  evidence.num_changes = 4;
  evidence.chi_squared = 1e4;
  evidence.systematic_px = 0.3;
  evidence.shape_change_in_sigmas = 20;
}

std::vector<Spoilt> SpoiltPrecision() {
  return {
      {"the principal point wanders by 20 px", ReportStatus::kBad,
       [](ClipFacts* facts) {
         facts->precision->steadiness.wander = PrincipalPointWander{20, 960};
       }},
      {"the principal point wanders by 9 px", ReportStatus::kCheck,
       [](ClipFacts* facts) {
         facts->precision->steadiness.wander = PrincipalPointWander{9, 960};
       }},
      {"the focal length changes from 960 to 1010 px about b.jpg", ReportStatus::kBad,
       [](ClipFacts* facts) {
         facts->precision->steadiness.step = FocalStep{"b.jpg", 1, 960, 1010, 30};
       }},
      {"the focal length changes from 960 to 982 px about b.jpg", ReportStatus::kCheck,
       [](ClipFacts* facts) {
         facts->precision->steadiness.step = FocalStep{"b.jpg", 1, 960, 982, 30};
       }},
      {"moves 15 degrees", ReportStatus::kCheck,
       [](ClipFacts* facts) { facts->precision->parallax_deg = 15; }},
      {"moves 5 degrees", ReportStatus::kBad,
       [](ClipFacts* facts) { facts->precision->parallax_deg = 5; }},
      {"contradicts the layout: marker 4", ReportStatus::kCheck,
       [](ClipFacts* facts) { facts->precision->markers_left_out = {"marker 4: out of line"}; }},
      {"the calibration does not belong to these images", ReportStatus::kBad, ContradictCamera},
      {"only 9 of 20 markers in 40 of 40 frames fit together: the calibration", ReportStatus::kBad,
       [](ClipFacts* facts) { facts->precision->num_markers = 9; }},
      {"only 20 of 20 markers in 13 of 40 frames fit together", ReportStatus::kBad,
       [](ClipFacts* facts) { facts->precision->num_images = 13; }},
      {"from these frames: because", ReportStatus::kBad, [](ClipFacts* facts) {
         facts->precision.reset();
         facts->no_precision_because = "because";
       }}};
}

TEST(ClipVerdict, EachFaultIsNamedByItself) {
  std::vector<Spoilt> cases = SpoiltPictures();
  for (const Spoilt& spoilt : SpoiltPrecision()) cases.push_back(spoilt);
  for (const Spoilt& spoilt : cases) {
    ClipFacts facts = GoodClip();
    spoilt.spoil(&facts);
    const Verdict verdict = JudgeClip(facts);
    EXPECT_EQ(verdict.level, spoilt.level) << spoilt.word;
    EXPECT_THAT(verdict.reasons, ElementsAre(Field(&VerdictReason::text, HasSubstr(spoilt.word))));
  }
}

// No calibration is blamed where none was given, and a zoom ends a reconstruction.
std::vector<Spoilt> SpoiltWithoutCalibration() {
  return {{"the camera cannot be found: the focal length changes from 960 to 982 px",
           ReportStatus::kBad,
           [](ClipFacts* facts) {
             facts->precision->steadiness.step = FocalStep{"b.jpg", 1, 960, 982, 30};
           }},
          {"the principal point wanders by 20 px", ReportStatus::kBad,
           [](ClipFacts* facts) {
             facts->precision->steadiness.wander = PrincipalPointWander{20, 960};
           }},
          {"fit together: the surface moved, or the lens was zoomed", ReportStatus::kBad,
           [](ClipFacts* facts) { facts->precision->num_markers = 9; }},
          {"film from more directions", ReportStatus::kBad, ContradictCamera},
          {"the pictures hardly determine the camera", ReportStatus::kBad,
           [](ClipFacts* facts) {
             facts->precision->found_cameras = {{UnknownCamera(1920, 1080, 1000), {80, 0, 0, 0}}};
           }},
          {"camera found; focal length 1000", ReportStatus::kBad,
           [](ClipFacts* facts) {
             facts->precision->found_cameras = {{UnknownCamera(1920, 1080, 1000), {80, 0, 0, 0}}};
           }},
          {"from these frames: because", ReportStatus::kBad,
           [](ClipFacts* facts) {
             facts->precision.reset();
             facts->no_precision_because = "because";
           }},
          {"are not checked without the markers' sizes", ReportStatus::kCheck,
           [](ClipFacts* facts) { facts->precision.reset(); }}};
}

TEST(ClipVerdict, WithoutACalibrationNoneIsBlamed) {
  for (const Spoilt& spoilt : SpoiltWithoutCalibration()) {
    ClipFacts facts = GoodClip();
    facts.has_camera = false;
    spoilt.spoil(&facts);
    const Verdict verdict = JudgeClip(facts);
    EXPECT_EQ(verdict.level, spoilt.level) << spoilt.word;
    EXPECT_THAT(verdict.reasons,
                ElementsAre(Field(&VerdictReason::text, AllOf(HasSubstr(spoilt.word),
                                                              Not(HasSubstr("the calibration"))))));
  }
}

// What the views lack is said once, and nothing else is blamed for it.
TEST(ClipVerdict, ViewsFromOnePlaceAreNamedOnceAndNotBlamedOnTheCalibration) {
  const std::string weak =
      "there is hardly any parallax: half of the points are seen within less than 1.9 degrees; "
      "therefore the points are known to 3.7 mm along the line of sight, but to 0.17 mm across it";
  const auto only_reason = [](const ClipFacts& facts) {
    const Verdict verdict = JudgeClip(facts);
    EXPECT_EQ(verdict.level, ReportStatus::kBad);
    EXPECT_EQ(verdict.reasons.size(), 1u);
    return verdict.reasons.at(0).text;
  };
  ClipFacts facts = GoodClip();
  facts.precision->parallax_deg = 2;
  facts.precision->warnings = {weak};
  EXPECT_THAT(only_reason(facts), HasSubstr("moves 2 degrees"));
  facts.precision->parallax_deg = 40;  // markers that most frames do not show
  EXPECT_THAT(JudgeClip(facts).reasons, ElementsAre(Field(&VerdictReason::text, weak)));
  facts.precision.reset();
  facts.no_precision_because = "the images leave the shape undetermined: " + weak;
  EXPECT_THAT(only_reason(facts), Not(HasSubstr("calibration")));
  facts.no_precision_because = "because";
  facts.shows_one_picture = true;
  EXPECT_THAT(only_reason(facts), HasSubstr("all frames with markers show the same picture"));
  facts.no_precision_because.clear();  // without the markers' sizes
  EXPECT_THAT(only_reason(facts), HasSubstr("all frames with markers show the same picture"));
}

// From 12 px on, hardly any marker is lost.
TEST(ClipVerdict, SmallMarkersThatAreFoundAreAHintOnly) {
  ClipFacts facts = GoodClip();
  EXPECT_EQ(SizeHint(facts), "");
  facts.side_px = ComputeStatistics({17.21});
  facts.precision->scale_sigma = 1.19e-3;
  EXPECT_EQ(JudgeClip(facts).level, ReportStatus::kGood);
  EXPECT_THAT(SizeHint(facts), HasSubstr("smaller than 17.2 px"));
  EXPECT_THAT(SizeHint(facts), HasSubstr("size is known to 0.12 %"));
  facts.precision.reset();
  EXPECT_THAT(SizeHint(facts), HasSubstr("a few tenths of a percent"));
  facts.side_px = ComputeStatistics({11.9});
  EXPECT_EQ(SizeHint(facts), "");
  EXPECT_EQ(JudgeClip(facts).level, ReportStatus::kBad);
}

TEST(ClipVerdict, MarkersAtTheEndOfALineAreToBeFilmed) {
  ClipFacts facts = GoodClip();
  facts.ids_never_seen = {21, 22, 23};
  facts.ids_unseen_between_seen = {22};
  EXPECT_THAT(
      JudgeClip(facts).reasons,
      ElementsAre(Field(&VerdictReason::text, HasSubstr("1 marker between seen ones is never")),
                  Field(&VerdictReason::text, HasSubstr("never seen: 21 23: film them"))));
}

TEST(ClipVerdict, WhatIsBadComesFirst) {
  ClipFacts facts = GoodClip();
  facts.white = 254;
  facts.side_px = ComputeStatistics({9});
  const Verdict verdict = JudgeClip(facts);
  EXPECT_EQ(verdict.level, ReportStatus::kBad);
  EXPECT_THAT(verdict.reasons, ElementsAre(Field(&VerdictReason::text, HasSubstr("9.0 px")),
                                           Field(&VerdictReason::text, HasSubstr("overexposed"))));
}

}  // namespace
}  // namespace velamap
