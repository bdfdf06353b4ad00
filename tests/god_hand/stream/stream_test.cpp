#include <zwang/experiments/god_hand/stream/stream.h>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/simulation.h>

#include "tests/folders.h"

namespace zwang::god {
namespace {

std::string socket_path() { return own_path("stream").string(); }

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

// Of this machine, over TCP: a frame is as long as its header says.
struct TcpClient {
  explicit TcpClient(const Stream& stream) : socket(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const std::string& where = stream.where();
    at.sin_port = htons(static_cast<std::uint16_t>(std::stoi(where.substr(where.rfind(':') + 1))));
    there = connect(socket, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0;
    const timeval patience{.tv_sec = 20, .tv_usec = 0};
    setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~TcpClient() { close(socket); }
  // The next frame whole; empty: the other side has gone.
  std::vector<unsigned char> next() {
    std::vector<unsigned char> message(sizeof(stream::Header));
    if (recv(socket, message.data(), message.size(), MSG_WAITALL) != static_cast<ssize_t>(message.size())) return {};
    stream::Header h{};
    std::memcpy(&h, message.data(), sizeof h);
    const std::size_t rest =
        h.bodies * sizeof(stream::Body) + h.loose * sizeof(stream::Pose) + h.contacts * sizeof(stream::Contact);
    message.resize(sizeof h + rest);
    if (recv(socket, message.data() + sizeof h, rest, MSG_WAITALL) != static_cast<ssize_t>(rest)) return {};
    return message;
  }

  int socket;
  bool there;
};

Stream::Say silent() {
  return [](const std::string&) {};
}

// With the time of sending left out.
std::vector<unsigned char> without_clock(std::vector<unsigned char> message) {
  std::fill_n(message.begin() + offsetof(stream::Header, sent), sizeof(stream::Header::sent), 0);
  return message;
}

TEST(Stream, TcpGetsTheBytesOfTheLocalSocket) {
  Stream out({socket_path(), "0"}, 32, silent());
  EXPECT_TRUE(out.where().starts_with(socket_path() + " and 127.0.0.1:")) << out.where();
  Client local(socket_path());
  TcpClient tcp(out);
  ASSERT_TRUE(local.there && tcp.there);
  for (long k = 0; k < 50; ++k) {
    out.send(frame_of(k));
    ASSERT_EQ(local.next().number, static_cast<std::uint64_t>(k));
    local.message.resize(static_cast<std::size_t>(local.size));
    ASSERT_EQ(tcp.next(), local.message) << k;
    local.message.resize(1 << 18);
  }
}

TEST(Stream, ASlowTcpReaderGetsWholeFramesAndSeesThoseItMissed) {
  constexpr std::uint64_t frames = 5000;
  Stream out({.address = "0"}, 32, silent());
  TcpClient client(out);
  for (std::uint64_t k = 0; k < frames; ++k) out.send(frame_of(static_cast<long>(k)));
  EXPECT_GT(out.missed(), 0);
  std::uint64_t got = 0, last = 0;
  const auto take = [&] {
    const std::vector<unsigned char> message = client.next();
    stream::Header h{};
    ASSERT_GE(message.size(), sizeof h);
    std::memcpy(&h, message.data(), sizeof h);
    ASSERT_EQ(h.magic, stream::magic);
    if (got++ > 0) {
      ASSERT_GT(h.number, last);
    }
    last = h.number;
  };
  const std::uint64_t wait = frames - static_cast<std::uint64_t>(out.missed());
  while (got + 1 < wait) take();  // of the last one a part may wait on the other side
  out.send(frame_of(frames));
  while (last < frames && got < wait + 1) take();
  EXPECT_EQ(last, frames);
}

// The same commands, one a step.
TEST(Stream, OneSimulationOverEitherSocketToTheBit) {
  const auto run = [](bool by_tcp) {
    Target hand{.palm = {{0, 0, 0.08}, Mat3::Identity()}};
    Simulation simulation(make_surroundings("box", ""), std::span(&hand::standard(), 1), std::span(&hand, 1),
                          {.verify = 0});
    Stream stream(by_tcp ? Stream::Place{.address = "127.0.0.1:0"} : Stream::Place{socket_path()}, hand::bodies,
                  silent());
    std::optional<TcpClient> tcp;
    std::optional<Client> local;
    if (by_tcp)
      tcp.emplace(stream);
    else
      local.emplace(socket_path());
    std::vector<std::vector<unsigned char>> frames;
    std::vector<Pose<double>> targets;
    for (int k = 0; k < 150; ++k) {
      hand.palm.position += Vec3(1e-4, 0, -5e-4);
      const hand::Poses wanted = hand::forward_kinematics(hand.palm, hand.angles, hand::standard());
      stream::Header h{};
      h.magic = stream::magic, h.version = stream::version, h.kind = stream::Kind::targets;
      h.number = static_cast<std::uint64_t>(k) + 1, h.bodies = hand::bodies;
      std::vector<unsigned char> message(sizeof h + hand::bodies * sizeof(stream::Pose));
      std::memcpy(message.data(), &h, sizeof h);
      for (std::size_t b = 0; b < wanted.size(); ++b) {
        const Eigen::Quaterniond q(wanted[b].rotation);
        stream::Pose pose{};
        std::copy_n(wanted[b].position.data(), 3, pose.position);
        std::copy_n(q.coeffs().data(), 4, pose.quaternion);
        std::memcpy(message.data() + sizeof h + b * sizeof pose, &pose, sizeof pose);
      }
      // Over TCP in two parts, the second of which is not there yet.
      const std::size_t cut = by_tcp ? message.size() / 3 : message.size();
      const int socket = by_tcp ? tcp->socket : local->socket;
      EXPECT_EQ(send(socket, message.data(), cut, 0), static_cast<ssize_t>(cut));
      if (by_tcp) {
        EXPECT_FALSE(stream.receive(targets));
        EXPECT_EQ(send(socket, message.data() + cut, message.size() - cut, 0),
                  static_cast<ssize_t>(message.size() - cut));
      }
      for (int tries = 0; !stream.receive(targets) && tries < 10000; ++tries)
        std::this_thread::sleep_for(std::chrono::microseconds(100));
      stream.send(simulation.step(targets));
      if (by_tcp) {
        frames.push_back(without_clock(tcp->next()));
      } else {
        local->message.resize(1 << 18);
        EXPECT_EQ(local->next().answers, static_cast<std::uint64_t>(k) + 1);
        local->message.resize(static_cast<std::size_t>(local->size));
        frames.push_back(without_clock(local->message));
      }
    }
    return frames;
  };
  const auto local = run(false), tcp = run(true);
  EXPECT_EQ(local, tcp);
  stream::Header last{};
  std::memcpy(&last, local.back().data(), sizeof last);
  EXPECT_TRUE(last.flags & stream::Flag::touching);
}

TEST(Stream, WhatIsNotTargetsEndsATcpConnectionToo) {
  std::vector<std::string> said;
  Stream in({.address = "0"}, 2, [&](const std::string& line) { said.push_back(line); });
  TcpClient client(in);
  const std::string request = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept: text/html, and so on and so forth\r\n\r\n";
  ASSERT_EQ(send(client.socket, request.data(), request.size(), 0), static_cast<ssize_t>(request.size()));
  std::vector<Pose<double>> targets;
  EXPECT_FALSE(in.receive(targets));
  ASSERT_EQ(said.size(), 2u);
  EXPECT_TRUE(said[1].find("that are not targets for 2 god objects") != std::string::npos) << said[1];
  EXPECT_TRUE(client.next().empty());
}

TEST(Stream, AnAddressThatCannotBeHadIsNamed) {
  const Stream first({.address = "0"}, 2, silent());
  for (const std::string& address : {first.where(), std::string("70000"), std::string("no port"), std::string(":")})
    try {
      Stream second({.address = address}, 2, silent());
      ADD_FAILURE() << address;
    } catch (const std::invalid_argument& refused) {
      EXPECT_TRUE(std::string(refused.what()).starts_with("--listen " + address + ": ")) << refused.what();
    }
}

TEST(Stream, AReaderThatKeepsUpGetsAllInOrderWithinAMillisecond) {
  constexpr long frames = 2000;
  Stream out({socket_path()}, 32, silent());
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
  Stream out({socket_path()}, 32, silent());
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
  Stream out({socket_path()}, 32, silent());
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
  auto out = std::make_unique<Stream>(Stream::Place{socket_path()}, 32,
                                      [&](const std::string& line) { said.push_back(line); });
  {
    Client client(socket_path());
    out->send(frame_of(0));
    EXPECT_EQ(client.next().number, 0u);
  }
  for (long k = 1; k < 10; ++k) out->send(frame_of(k));
  EXPECT_EQ(said, (std::vector<std::string>{"a reader is there from frame 0 on",
                                            "a reader has left at frame 1, which missed 0 frames"}));
  EXPECT_THROW(Stream({socket_path()}, 32, [](const std::string&) {}), std::invalid_argument);  // taken
  Client last(socket_path());
  out->send(frame_of(10));
  EXPECT_EQ(last.next().number, 10u);
  out.reset();
  EXPECT_EQ(last.next().number, ~0ull);
  EXPECT_FALSE(std::filesystem::exists(socket_path()));
}

TEST(Stream, TakesTheNewestTargetsAndNothingElse) {
  std::vector<std::string> said;
  Stream in({socket_path()}, 2, [&](const std::string& line) { said.push_back(line); });
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
