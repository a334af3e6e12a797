#include "reconstruct/registration/dictionary_doubt.h"

#include <random>

#include <gmock/gmock.h>

#include "tests/reconstruct/registration_fixture.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

DatabaseImage ImageOf(const std::vector<int>& marker_ids) {
  DatabaseImage image;
  for (const int marker_id : marker_ids) {
    MarkerDetection marker;
    marker.marker_id = marker_id;
    image.detections.markers.push_back(marker);
  }
  return image;
}

TEST(DictionaryDoubt, FalseIdsOfALargeDictionaryAreDoubted) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> id(0, 249), count(2, 6);
    std::vector<DatabaseImage> images;
    for (int i = 0; i < 18; ++i) {
      std::vector<int> ids(static_cast<std::size_t>(count(random)));
      for (int& one : ids) one = id(random);
      images.push_back(ImageOf(ids));
    }
    EXPECT_THAT(DictionaryDoubt(images), HasSubstr("in only one of the 18 images")) << seed;
  }
}

TEST(DictionaryDoubt, FewMarkersAnImageAreDoubted) {
  EXPECT_THAT(DictionaryDoubt({ImageOf({1, 2}), ImageOf({2, 3}), ImageOf({3, 1})}),
              HasSubstr("3 images hold 2.0 markers each"));
}

TEST(DictionaryDoubt, MarkersThatAreSeenAgainAreNot) {
  SyntheticSceneOptions options;
  for (const SceneKind kind : {SceneKind::kSail, SceneKind::kPlane, SceneKind::kCube}) {
    options.kind = kind;
    EXPECT_THAT(DictionaryDoubt(DatabaseImages(MakeSyntheticScene(options))), IsEmpty());
  }
  EXPECT_THAT(DictionaryDoubt({ImageOf({1, 2, 3, 4})}), IsEmpty());
}

}  // namespace
}  // namespace velamap
