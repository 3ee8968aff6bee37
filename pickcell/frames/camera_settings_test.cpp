#include "pickcell/frames/camera_settings.hpp"

#include <gtest/gtest.h>

namespace pickcell::frames {
namespace {

TEST(CameraSettings, ReadsItsKeysAndLeavesTheOthersToTheCamera) {
  const auto s =
      parse_camera_settings({"exposure_us=1250.5", "gain=-3", "fps=12", "pixel_format=Mono12p", "roi_px=8,16,640,480",
                             "binning=2", "trigger=software", "packet_bytes=8192", "resend=false",
                             "chunks=ExposureTime,EncoderValue", "GainAuto=Off", "Name=a=b"});
  ASSERT_TRUE(s) << s.error().line();
  EXPECT_EQ(s->exposure_us, 1250.5);
  EXPECT_EQ(s->gain, -3);
  EXPECT_EQ(s->roi_px, (std::array{8, 16, 640, 480}));
  EXPECT_TRUE(s->software_triggered());
  EXPECT_FALSE(s->free_running());
  EXPECT_FALSE(s->resend);
  EXPECT_EQ(s->chunks, "ExposureTime,EncoderValue");
  ASSERT_EQ(s->features.size(), 2u);
  EXPECT_EQ(s->features[1], std::pair(std::string("Name"), std::string("a=b")));
}

TEST(CameraSettings, RefusesValuesThatAreNone) {
  for (const std::string word :
       {"exposure_us=fast", "exposure_us=0", "exposure_us=nan", "exposure_us=", "fps=-1", "roi_px=1,2,3",
        "roi_px=1,2,3,0", "roi_px=1,2,3,4,5", "roi_px=-1,0,4,4", "binning=0", "binning=2.5", "packet_bytes=100",
        "resend=perhaps", "=3", "exposure", "trigger=", "gain=1e999"}) {
    const auto refused = parse_camera_settings({word});
    ASSERT_FALSE(refused) << word;
    EXPECT_EQ(refused.error().code, core::ErrorCode::usage);
  }
}

}  // namespace
}  // namespace pickcell::frames
