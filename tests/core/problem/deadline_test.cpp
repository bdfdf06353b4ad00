#include <zwang/core/problem/deadline.h>

#include <gtest/gtest.h>

#include <thread>

namespace zwang {
namespace {

TEST(Deadline, IsOfCpuTimeNotOfTheWallClock) {
  const Deadline deadline(0.05);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(deadline.passed());
  const double start = thread_cpu_seconds();
  while (!deadline.passed()) {
    EXPECT_LE(deadline.left(), 0.051);
    ASSERT_LT(thread_cpu_seconds() - start, 0.1);
  }
  EXPECT_GT(thread_cpu_seconds() - start, 0.045);
}

TEST(Deadline, HasAnEndOnlyWhereTheLimitIsFinite) {
  EXPECT_TRUE(Deadline(0).passed());
  EXPECT_TRUE(Deadline(-1).passed());
  EXPECT_FALSE(Deadline().passed());
  EXPECT_EQ(Deadline().left(), std::numeric_limits<double>::infinity());
  EXPECT_NO_THROW(Deadline().keep());
  EXPECT_THROW(Deadline(0).keep(), Stopped);
}

// The system call is rare: a solve of microseconds would feel it.
TEST(Deadline, ReadsTheClockOfTheThreadOnceInAHundredthOfTheLimit) {
  const Deadline deadline(1000);
  const double before = thread_cpu_seconds(1e9);
  seconds_elsewhere += 100;  // seen by whoever reads
  EXPECT_LT(thread_cpu_seconds(10) - before, 50);
  EXPECT_GT(thread_cpu_seconds(0) - before, 99);
  EXPECT_LT(deadline.left(), 901);
  seconds_elsewhere -= 100;
}

}  // namespace
}  // namespace zwang
