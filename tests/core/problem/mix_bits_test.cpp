#include <zwang/core/problem/mix_bits.h>

#include <gtest/gtest.h>

namespace zwang {
namespace {

// The values that Noll's test suite lists.
TEST(Fnv1a, GivesThePublishedHashes) {
  EXPECT_EQ(fnv1a(""), 0xcbf29ce484222325u);
  EXPECT_EQ(fnv1a("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(fnv1a("foobar"), 0x85944171f73967e8u);
  EXPECT_EQ(fnv1a("bar", fnv1a("foo")), fnv1a("foobar"));
  EXPECT_EQ(fnv1a("\xff"), (0xcbf29ce484222325u ^ 0xff) * 0x100000001b3u) << "bytes are unsigned";
}

}  // namespace
}  // namespace zwang
