#include "importer/text/shown_text.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(StripFolders, AbsolutePathsLoseTheirFolders) {
  EXPECT_EQ(StripFolders("/home/jo/camera.yml: is empty"), "camera.yml: is empty");
  EXPECT_EQ(StripFolders("--image_path /home/jo/sail/ --camera_path=/home/jo/c.yml"),
            "--image_path sail/ --camera_path=c.yml");
  EXPECT_EQ(StripFolders("'/a/b c' (/d/e), \"/f/g\"; log: /h/i"), "'b c' (e), \"g\"; log: i");
  EXPECT_EQ(StripFolders("TMPDIR /nowhere: none"), "TMPDIR nowhere: none");
}

TEST(StripFolders, OtherTextStays) {
  for (const char* text : {"", "/", "a / b", "3.5/s, 1/2", "day1/a.jpg", "../b/c.jpg",
                           "see https://a.b/c/d", "and/or", "a//b", "// c"}) {
    EXPECT_EQ(StripFolders(text), text);
  }
}

TEST(StripFolders, NamesWithSpacesAreKnownOncePathsAreMentioned) {
  RegisterPrivatePath("/media/Jo Doe/My Disk/clip 1.mp4");
  EXPECT_EQ(StripFolders("read /media/Jo Doe/My Disk/clip 1.mp4 and /media/Jo Doe/My Disk/b"),
            "read clip 1.mp4 and b");
}

TEST(StripFolders, StaysAsItIsWhereFoldersAreAskedFor) {
  ShowFolders(true);
  EXPECT_EQ(StripFolders("/home/jo/camera.yml"), "/home/jo/camera.yml");
  ShowFolders(false);
  EXPECT_EQ(StripFolders("/home/jo/camera.yml"), "camera.yml");
}

}  // namespace
}  // namespace velamap
