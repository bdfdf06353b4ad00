#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <zwang/experiments/god_hand/step/frame.h>
#include <zwang/experiments/god_hand/stream/message.h>

namespace zwang::god {

// Frames to any number of readers, targets from whoever sends them, over a UNIX socket of whole messages in order
// (SOCK_SEQPACKET; layout: message.h, docs/stream.md). The loop that sends never waits: a reader whose buffer is full
// misses frames, and sees that by their numbers. Readers may come and go.
class Stream {
 public:
  using Say = std::function<void(const std::string& line)>;

  // Listens at `path`; a socket there that nobody listens at is replaced. `say` is told who came and went, a line each.
  // Throws std::invalid_argument, one line, where the path is taken or cannot be had.
  Stream(std::string path, std::size_t bodies, Say say);
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  void send(const Frame& frame);
  // The newest targets that came in since the last call, one pose a god object. False: none.
  bool receive(std::vector<Pose<double>>& targets);

  std::size_t readers() const { return peers_.size(); }
  long missed() const { return missed_; }  // messages that a reader had no room for

 private:
  struct Peer {
    int socket;
    long missed;
  };
  void accept();
  void drop(std::size_t peer, const std::string& why);
  void write(const Frame& frame);

  std::string path_;
  std::size_t bodies_;
  Say say_;
  int listener_ = -1;
  std::vector<Peer> peers_;
  std::vector<unsigned char> out_, in_;
  std::uint64_t answers_ = 0, last_ = 0;
  long missed_ = 0;
};

// CLOCK_MONOTONIC [ns].
std::int64_t monotonic_ns();

}  // namespace zwang::god
