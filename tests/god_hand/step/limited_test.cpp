#include <zwang/experiments/god_hand/step/following.h>
#include "tests/god_hand/loose_box.h"
#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

constexpr int frames_of_each = 240;

Options with_friction(int iterations = 100, double budget = 0) {
  Options o;
  o.verify = 20;
  o.iterations = iterations;
  o.budget = budget;
  return o;
}

// Goes down for 200 frames, then aside.
auto target_of(int frame) {
  const double down = std::min(frame, 200) * 1e-3, aside = std::max(frame - 200, 0) * 5e-4;
  return hand_at(posed(aside, 0, 0.2 - down), 0.3);
}

// A hand comes down on the floor and a loose box, goes on into both, and slides aside. No frame is not true to its
// word.
std::vector<Frame> slide(const Options& options) {
  Surroundings s = floor_of();
  s.objects.push_back(loose_box({0, 0.06, 0.031}));
  Simulation simulation = one_hand(s, hand_at(posed(0, 0, 0.2)), options);
  std::vector<Frame> frames;
  for (int k = 0; k < frames_of_each; ++k) {
    const Frame& f = frames.emplace_back(go(simulation, target_of(k)));
    EXPECT_GE(f.gap, 0) << k;
    EXPECT_LE(f.separation, closed_within) << k;
    EXPECT_LE(f.limit, closed_within) << k;
    EXPECT_NE(f.verified, Verdict::wrong) << k;
    EXPECT_TRUE(f.claimed == Status::solved || f.origin == Origin::limited) << k;
  }
  return frames;
}

long limited(const std::vector<Frame>& frames) { return std::ranges::count(frames, Origin::limited, &Frame::origin); }

void expect_same_until(std::size_t end, const std::vector<Frame>& a, const std::vector<Frame>& b) {
  for (std::size_t k = 0; k < end; ++k) EXPECT_TRUE(std::ranges::equal(a[k].god, b[k].god, is_same)) << k;
}

TEST(Limited, ASolveThatMeetsItsLimitIsAnsweredUnderASimplerLaw) {
  const std::vector<Frame> whole = slide(with_friction());
  EXPECT_EQ(limited(whole), 0);
  for (const int iterations : {1, 12}) {
    const std::vector<Frame> frames = slide(with_friction(iterations));
    const auto first = std::ranges::find(frames, Origin::limited, &Frame::origin) - frames.begin();
    EXPECT_GT(first, 50);
    EXPECT_GT(limited(frames), 20) << iterations;
    EXPECT_TRUE(std::ranges::none_of(frames, &Frame::held)) << iterations;
    // Where the limit comes a few steps after a motion has settled, that is an answer short of its last digits. (Hands
    // that differ by those part once they touch.)
    std::size_t k = 0;
    while (k < static_cast<std::size_t>(first) && std::ranges::equal(whole[k].god, frames[k].god, is_same)) ++k;
    EXPECT_GT(k, 50u);
    for (std::size_t b = 0; b < hand::bodies && k < static_cast<std::size_t>(first); ++b)
      EXPECT_LE((frames[k].god[b].position - whole[k].god[b].position).norm(), 1e-12) << k;
  }
}

TEST(Limited, WithoutTimeTheHandStaysWhereItIs) {
  for (const double mu : {0.0, 0.8}) {
    Options o = with_friction(100, 1e-9);
    o.mu = mu;
    const std::vector<Frame> frames = slide(o);
    EXPECT_EQ(limited(frames), frames_of_each) << mu;
    for (std::size_t b = 0; b < hand::bodies; ++b)
      EXPECT_LE((frames.back().god[b].position - frames[0].god[b].position).norm(), closed_within) << b;
  }
}

TEST(Limited, ABudgetThatIsNeverMetChangesNothing) {
  const std::vector<Frame> whole = slide(with_friction()), in_time = slide(with_friction(100, 1e5));
  expect_same_until(whole.size(), whole, in_time);
  EXPECT_EQ(limited(in_time), 0);
}

TEST(Limited, ASmallBudgetIsTrueToItsWord) {
  const std::vector<Frame> frames = slide(with_friction(100, 0.01));
  EXPECT_GT(limited(frames), 0);
}

// From the same state each frame ends as near as was asked, a sub-step at a time.
TEST(Accuracy, AFrameIsAsNearAsWasAsked) {
  Surroundings scene = floor_of();
  scene.objects.push_back(loose_box({0, 0.06, 0.031}));
  Options exact = with_friction(), near = exact;
  near.accuracy = "1e-4m/s";
  near.verify = 1;
  Simulation a = one_hand(scene, hand_at(posed(0, 0, 0.2)), exact),
             b = one_hand(scene, hand_at(posed(0, 0, 0.2)), near);
  double most = 0;
  for (int k = 0; k < frames_of_each; ++k) {
    b.restore(a.checkpoint());
    const std::vector<Pose<double>> whole = go(a, target_of(k)).god;
    const Frame& f = go(b, target_of(k));
    EXPECT_NE(f.verified, Verdict::wrong) << k;
    for (std::size_t body = 0; body < hand::bodies; ++body)
      most = std::max(most, (f.god[body].position - whole[body].position).norm());
  }
  EXPECT_GT(most, 0);
  EXPECT_LE(most, near.sub_steps * 1e-4 * near.dt);
}

}  // namespace
}  // namespace zwang::god
