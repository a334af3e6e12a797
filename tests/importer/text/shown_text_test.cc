#include "importer/text/shown_text.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(WithoutFolders, AbsolutePathsLoseTheirFolders) {
  EXPECT_EQ(WithoutFolders("/home/jo/camera.yml: is empty"), "camera.yml: is empty");
  EXPECT_EQ(WithoutFolders("--image_path /home/jo/sail/ --camera_path=/home/jo/c.yml"),
            "--image_path sail/ --camera_path=c.yml");
  EXPECT_EQ(WithoutFolders("'/a/b c' (/d/e), \"/f/g\"; log: /h/i"), "'b c' (e), \"g\"; log: i");
  EXPECT_EQ(WithoutFolders("TMPDIR /nowhere: none"), "TMPDIR nowhere: none");
}

TEST(WithoutFolders, OtherTextStays) {
  for (const char* text : {"", "/", "a / b", "3.5/s, 1/2", "day1/a.jpg", "../b/c.jpg",
                           "see https://a.b/c/d", "and/or", "a//b", "// c"}) {
    EXPECT_EQ(WithoutFolders(text), text);
  }
}

TEST(WithoutFolders, NamesWithSpacesAreKnownOncePathsAreMentioned) {
  MentionPath("/media/Jo Doe/My Disk/clip 1.mp4");
  EXPECT_EQ(WithoutFolders("read /media/Jo Doe/My Disk/clip 1.mp4 and /media/Jo Doe/My Disk/b"),
            "read clip 1.mp4 and b");
}

TEST(WithoutFolders, StaysAsItIsWhereFoldersAreAskedFor) {
  ShowFolders(true);
  EXPECT_EQ(WithoutFolders("/home/jo/camera.yml"), "/home/jo/camera.yml");
  ShowFolders(false);
  EXPECT_EQ(WithoutFolders("/home/jo/camera.yml"), "camera.yml");
}

}  // namespace
}  // namespace velamap
