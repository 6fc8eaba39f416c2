// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cstdio>
#include <set>

#include <sys/wait.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include "pipeline/state/state_file.h"
#include "tests/places.h"
#include "tests/unit/pipeline/state/cushion_state.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::stages::picture {
namespace {

using geometry::ElementType;
using testing::HasSubstr;
using tests::cushion_state;
using tests::TemporaryFolder;

struct Ended {
  int code = -1;      // -1: by a signal
  std::string output; // standard output and error
};

// Runs the program under test; `environment` as in a shell. The OpenGL driver's own leaks are not ours to report.
Ended picture(const std::string& arguments, const std::string& environment = "") {
  const std::string command = fmt::format("unset DISPLAY; ASAN_OPTIONS=detect_leaks=0 {} {}/pneuma-picture {} 2>&1",
                                          environment, tests::program_folder, arguments);
  Ended ended;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return ended;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    ended.output.append(buffer.data(), count);
  }
  const int status = pclose(pipe);
  if (WIFEXITED(status)) ended.code = WEXITSTATUS(status);
  return ended;
}

// Colours of a PNG file of the size expected.
std::set<std::array<int, 3>> colours(const std::filesystem::path& path, int width, int height) {
  std::set<std::array<int, 3>> found;
  const vtkNew<vtkPNGReader> reader;
  if (reader->CanReadFile(path.c_str()) == 0) {
    ADD_FAILURE() << path << " is no PNG";
    return found;
  }
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  EXPECT_EQ(image->GetDimensions()[0], width);
  EXPECT_EQ(image->GetDimensions()[1], height);
  for (int y = 0; y < image->GetDimensions()[1]; ++y) {
    for (int x = 0; x < image->GetDimensions()[0]; ++x) {
      const auto* pixel = static_cast<const unsigned char*>(image->GetScalarPointer(x, y, 0));
      found.insert({pixel[0], pixel[1], pixel[2]});
    }
  }
  return found;
}

class Picture : public testing::Test {
protected:
  Picture() { pipeline::state::write_state(cushion_state(ElementType::T6, 4, 2), folder / "a.hdf"); }
  // the program's arguments with the state and the picture
  Ended draw(const std::string& arguments, const std::string& environment = "") const {
    return picture(fmt::format("{} --out {} {}", (folder / "a.hdf").string(), (folder / "a.png").string(), arguments),
                   environment);
  }
  TemporaryFolder folder;
};

TEST_F(Picture, OfAFieldHasTheSizeAskedForAndManyColours) {
  const Ended ended = draw("--field von_mises --size 400x300 --title 'Two foils' --explode 0.5");
  EXPECT_EQ(ended.code, 0) << ended.output;
  EXPECT_EQ(ended.output, "");
  EXPECT_GT(colours(folder / "a.png", 400, 300).size(), 500U);
}

TEST_F(Picture, OfEveryElementAndViewIsDrawn) {
  for (const ElementType type : {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9}) {
    pipeline::state::write_state(cushion_state(type, 3, 2), folder / "a.hdf");
    for (const char* view : {"iso", "top", "side"}) {
      const Ended ended = draw(fmt::format("--field displacement --component 2 --size 200x150 --view {}", view));
      EXPECT_EQ(ended.code, 0) << ended.output;
      EXPECT_GT(colours(folder / "a.png", 200, 150).size(), 100U) << geometry::name_of(type) << " " << view;
    }
  }
}

TEST_F(Picture, WithoutAFieldShowsTheMesh) {
  const Ended ended = draw("--field none --size 200x150");
  EXPECT_EQ(ended.code, 0) << ended.output;
  EXPECT_GT(colours(folder / "a.png", 200, 150).size(), 20U);
}

TEST_F(Picture, IsDrawnFromValuesThatAreNotNumbersToo) {
  pipeline::state::State state = cushion_state(ElementType::Q4, 3, 2);
  std::fill(state.fields[1].values.begin(), state.fields[1].values.end(), std::nan(""));
  pipeline::state::write_state(state, folder / "a.hdf");
  const Ended ended = draw("--field von_mises --size 200x150");
  EXPECT_EQ(ended.code, 0) << ended.output;
  EXPECT_GT(colours(folder / "a.png", 200, 150).size(), 20U);
}

TEST_F(Picture, DependsOnTheWarpFactor) {
  EXPECT_EQ(draw("--field none --view side --size 200x150").code, 0);
  const std::string once = tests::bytes_of(folder / "a.png");
  EXPECT_EQ(draw("--field none --view side --size 200x150 --warp 1").code, 0);
  EXPECT_EQ(tests::bytes_of(folder / "a.png"), once);
  EXPECT_EQ(draw("--field none --view side --size 200x150 --warp 20").code, 0);
  EXPECT_NE(tests::bytes_of(folder / "a.png"), once);
}

TEST_F(Picture, OfAnUnknownFieldNamesTheNearest) {
  const Ended ended = draw("--field von_mieses");
  EXPECT_EQ(ended.code, 2);
  EXPECT_THAT(ended.output, HasSubstr("did you mean `von_mises`"));
  EXPECT_THAT(ended.output, HasSubstr("displacement, sag, von_mises, none"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

TEST_F(Picture, RefusesWrongOptionsWithWhatIsAllowed) {
  const std::pair<const char*, const char*> cases[] = {
      {"--field sag --size 40", "is not WxH"},
      {"--field sag --size 4x400", "is not a whole number from 64 to 8192"},
      {"--field sag --view tpo", "did you mean `top`"},
      {"--field sag --ragne 1 2", "did you mean `--range`"},
      {"--field sag --range 2 1", "is not below"},
      {"--field sag --range 2", "needs 2 values"},
      {"--field displacement --component 3", "components 0 .. 2"},
      {"--field sag --explode a", "is not a number"},
      {"", "--field is missing"},
  };
  for (const auto& [arguments, complaint] : cases) {
    const Ended ended = draw(arguments);
    EXPECT_EQ(ended.code, 2) << arguments;
    EXPECT_THAT(ended.output, HasSubstr(complaint));
  }
}

TEST_F(Picture, OfADamagedOrMissingStateEndsInThree) {
  tests::put_bytes(folder / "a.hdf", tests::bytes_of(folder / "a.hdf") + "x");
  EXPECT_EQ(draw("--field sag").code, 3);
  std::filesystem::remove(folder / "a.hdf");
  EXPECT_EQ(draw("--field sag").code, 3);
}

TEST_F(Picture, WithoutEglSaysWhatToInstall) {
  const Ended ended = draw("--field sag", "__EGL_VENDOR_LIBRARY_DIRS=/nonexistent");
  EXPECT_EQ(ended.code, 2) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("Install libegl1"));
}

TEST_F(Picture, IntoAFolderThatIsMissingIsAnError) {
  const Ended ended = picture(fmt::format("{} --out {} --field sag --size 100x100", (folder / "a.hdf").string(),
                                          (folder / "none/a.png").string()));
  EXPECT_EQ(ended.code, 6) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("cannot be written"));
}

} // namespace
} // namespace pneuma::stages::picture
