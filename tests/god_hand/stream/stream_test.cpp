#include <zwang/experiments/god_hand/stream/stream.h>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include <zwang/experiments/god_hand/step/options.h>

#include "tests/folders.h"

namespace zwang::god {
namespace {

std::string socket_path() {
  return (std::filesystem::temp_directory_path() / ("zwang-stream-" + std::to_string(getpid()))).string();
}

Frame frame_of(long number) {
  Frame f;
  f.number = number;
  f.time = 1e-3 * static_cast<double>(number);
  f.god.resize(32), f.target.resize(32), f.loose.resize(5), f.contacts.resize(20);
  f.god[3].position.x() = static_cast<double>(number);
  f.device.assign(32, Vec<double, 6>::Constant(0.5));
  return f;
}

struct Client {
  explicit Client(const std::string& path) : socket(::socket(AF_UNIX, SOCK_SEQPACKET, 0)), message(1 << 18) {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::strcpy(at.sun_path, path.c_str());
    there = connect(socket, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0;
  }
  ~Client() { close(socket); }
  // The next frame's header; number ~0: the other side has gone, or nothing waits and `wait` is false.
  stream::Header next(bool wait = true) {
    stream::Header h{};
    h.number = ~0ull;
    size = recv(socket, message.data(), message.size(), wait ? 0 : MSG_DONTWAIT);
    if (size > 0) std::memcpy(&h, message.data(), sizeof h);
    return h;
  }

  int socket;
  bool there;
  std::vector<unsigned char> message;
  ssize_t size = 0;
};

TEST(Stream, AReaderThatKeepsUpGetsAllInOrderWithinAMillisecond) {
  constexpr long frames = 2000;
  Stream out(socket_path(), 32, [](const std::string&) {});
  Client client(socket_path());
  ASSERT_TRUE(client.there);
  std::vector<double> age;  // s
  std::vector<std::uint64_t> numbers;
  std::thread reader([&] {
    while (numbers.size() < frames) {
      const stream::Header h = client.next();
      if (h.number == ~0ull) break;
      age.push_back(1e-9 * static_cast<double>(monotonic_ns() - h.sent));
      numbers.push_back(h.number);
    }
  });
  for (long k = 0; k < frames; ++k) {
    out.send(frame_of(k));
    std::this_thread::sleep_for(std::chrono::microseconds(900));
  }
  reader.join();
  ASSERT_EQ(numbers.size(), static_cast<std::size_t>(frames));
  for (std::size_t k = 0; k < numbers.size(); ++k) ASSERT_EQ(numbers[k], k);
  std::nth_element(age.begin(), age.begin() + frames / 2, age.end());
  EXPECT_LT(age[frames / 2], 1e-3);
  EXPECT_EQ(out.missed(), 0);
}

TEST(Stream, HoldsTheFrame) {
  Stream out(socket_path(), 32, [](const std::string&) {});
  Client client(socket_path());
  out.send(frame_of(7));
  const stream::Header h = client.next();
  EXPECT_EQ(h.magic, stream::magic);
  EXPECT_EQ(h.bodies, 32u);
  EXPECT_EQ(h.loose, 5u);
  EXPECT_EQ(h.contacts, 20u);
  EXPECT_EQ(static_cast<std::size_t>(client.size), 64 + 32 * sizeof(stream::Body) + 5 * 56 + 20 * 72);
  stream::Body body{};
  std::memcpy(&body, client.message.data() + 64 + 3 * sizeof body, sizeof body);
  EXPECT_EQ(body.god.position[0], 7);
  EXPECT_EQ(body.god.quaternion[3], 1);
  EXPECT_EQ(body.torque[2], 0.5);
}

TEST(Stream, ASlowReaderMissesFramesAndSeesIt) {
  constexpr long frames = 5000;
  Stream out(socket_path(), 32, [](const std::string&) {});
  Client client(socket_path());
  const Frame f = frame_of(0);
  const std::int64_t start = monotonic_ns();
  for (long k = 0; k < frames; ++k) out.send(frame_of(k));
  EXPECT_LT(1e-9 * static_cast<double>(monotonic_ns() - start), 20);  // nobody waits
  EXPECT_GT(out.missed(), 0);
  std::uint64_t got = 0, last = 0;
  for (stream::Header h; (h = client.next(false)).number != ~0ull; ++got) {
    if (got > 0) {
      EXPECT_GT(h.number, last);
    }
    last = h.number;
  }
  EXPECT_EQ(got + static_cast<std::uint64_t>(out.missed()), static_cast<std::uint64_t>(frames));
  out.send(frame_of(frames));
  EXPECT_EQ(client.next().number, static_cast<std::uint64_t>(frames));
  EXPECT_GT(static_cast<std::uint64_t>(frames) - last, 1u);  // the gap
}

TEST(Stream, EitherSideSurvivesTheOthersDeath) {
  std::vector<std::string> said;
  auto out = std::make_unique<Stream>(socket_path(), 32, [&](const std::string& line) { said.push_back(line); });
  {
    Client client(socket_path());
    out->send(frame_of(0));
    EXPECT_EQ(client.next().number, 0u);
  }
  for (long k = 1; k < 10; ++k) out->send(frame_of(k));
  EXPECT_EQ(said, (std::vector<std::string>{"a reader is there from frame 0 on",
                                            "a reader has left at frame 1, which missed 0 frames"}));
  EXPECT_THROW(Stream(socket_path(), 32, [](const std::string&) {}), std::invalid_argument);  // taken
  Client last(socket_path());
  out->send(frame_of(10));
  EXPECT_EQ(last.next().number, 10u);
  out.reset();
  EXPECT_EQ(last.next().number, ~0ull);
  EXPECT_FALSE(std::filesystem::exists(socket_path()));
}

TEST(Stream, TakesTheNewestTargetsAndNothingElse) {
  std::vector<std::string> said;
  Stream in(socket_path(), 2, [&](const std::string& line) { said.push_back(line); });
  std::vector<Pose<double>> targets;
  EXPECT_FALSE(in.receive(targets));
  Client client(socket_path());
  struct {
    stream::Header h;
    stream::Pose pose[2];
  } message{};
  static_assert(sizeof message == 64 + 2 * 56);
  message.h.magic = stream::magic, message.h.version = stream::version, message.h.kind = stream::Kind::targets;
  message.h.bodies = 2;
  for (int k = 1; k <= 3; ++k) {
    message.h.number = static_cast<std::uint64_t>(k);
    message.pose[0] = {{1. * k, 2, 3}, {0, 0, 0, 2}};
    message.pose[1] = {{0, 0, 0}, {0, 0, 1, 0}};
    ASSERT_EQ(send(client.socket, &message, sizeof message, 0), static_cast<ssize_t>(sizeof message));
  }
  ASSERT_TRUE(in.receive(targets));
  ASSERT_EQ(targets.size(), 2u);
  EXPECT_EQ(targets[0].position, Vec3(3, 2, 3));
  EXPECT_TRUE(targets[0].rotation.isIdentity(1e-15));
  EXPECT_NEAR(targets[1].rotation(0, 0), -1, 1e-15);
  Frame f = frame_of(0);
  in.send(f);
  EXPECT_EQ(client.next().answers, 3u);
  message.h.version = 9;
  send(client.socket, &message, sizeof message, 0);
  EXPECT_FALSE(in.receive(targets));
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(said[1],
            "a reader sent 176 bytes that are not targets for 2 god objects (docs/stream.md): disconnected at frame 0, "
            "which missed 0 frames");
}

// `live` has no option for it: docs/stream.md names the value that it takes.
TEST(Stream, ThePageNamesTheStiffnessOfTheForceThatIsSent) {
  std::ifstream in(source_dir() / "docs/stream.md");
  const std::string page(std::istreambuf_iterator<char>(in), {}), before = "`force_stiffness`, ";
  const auto begin = page.find(before);
  ASSERT_NE(begin, std::string::npos);
  std::string number = page.substr(begin + before.size(), page.find(" / s^2", begin) - begin - before.size());
  std::erase(number, ',');
  EXPECT_EQ(number, std::to_string(std::lround(chosen({}).force_stiffness)));
}

}  // namespace
}  // namespace zwang::god
