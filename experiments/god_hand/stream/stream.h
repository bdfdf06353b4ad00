#pragma once

#include <functional>
#include <string>
#include <vector>

#include <zwang/experiments/god_hand/step/frame.h>
#include <zwang/experiments/god_hand/stream/message.h>

namespace zwang::god {

// Frames to any number of readers, targets from whoever sends them: over a local socket of whole messages in order
// (SOCK_SEQPACKET), over TCP, or both; the same bytes (message.h, docs/stream.md). The loop that sends never waits: a
// reader whose buffer is full misses frames, and sees that by their numbers. Readers may come and go.
class Stream {
 public:
  using Say = std::function<void(const std::string& line)>;
  // A path of a local socket, "HOST:PORT" or "PORT" (of this machine alone; 0: one that is free). Empty: not there.
  struct Place {
    std::string socket = {}, address = {};
  };

  // Listens there; a local socket that nobody listens at is replaced. `say` is told who came and went, a line each.
  // Throws std::invalid_argument, one line, where a place is taken or cannot be had.
  Stream(const Place& place, std::size_t bodies, Say say);
  ~Stream();
  Stream(Stream&&) = delete;

  void send(const Frame& frame);
  // The newest targets that came in since the last call, one pose a god object. False: none.
  bool receive(std::vector<Pose<double>>& targets);

  const std::string& where() const { return where_; }  // "/tmp/hand and 127.0.0.1:4567"
  long missed() const { return missed_; }  // messages that a reader had no room for

 private:
  struct Peer {
    int socket;
    bool whole;  // messages, not bytes
    long missed = 0;
    std::size_t have = 0;                  // bytes of the message that is coming in
    std::vector<unsigned char> in;         // and these
    std::vector<unsigned char> rest = {};  // of a frame that had room in part
  };
  void listen_at(const std::string& path);
  void listen_on(const std::string& address);
  void accept();
  void drop(std::size_t peer, const std::string& why);
  void write(const Frame& frame);
  void close_all();
  [[noreturn]] void fail(const std::string& where, const std::string& why);

  std::string path_, where_;
  std::size_t bodies_;
  Say say_;
  int local_ = -1, tcp_ = -1;
  std::vector<Peer> peers_;
  std::vector<unsigned char> out_;
  std::uint64_t answers_ = 0, last_ = 0;
  long missed_ = 0;
};

// CLOCK_MONOTONIC [ns].
std::int64_t monotonic_ns();

}  // namespace zwang::god
