#pragma once

#include <cerrno>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace zwang {

// A child's status as of waitpid, once it has ended.
int wait_for_child(int child);

// A child process at the other end of a stream socket, killed with this object, and with it what it has started.
class Peer {
 public:
  Peer() = default;
  ~Peer() { stop(); }
  Peer(Peer&&) = delete;

  // Runs `life` with its end of the socket in a forked process, which ends with it, or when this process does. Its
  // stdin, stdout and stderr are /dev/null, it leaves no core file and ignores Ctrl-C (this process decides). Neither
  // destructors nor what is registered with atexit run there. Throws std::system_error.
  void start(const std::function<void(int socket)>& life);
  int stop();  // its status as of waitpid
  bool runs() const { return pid_ >= 0; }
  int pid() const { return pid_; }
  int socket() const { return socket_; }

 private:
  int pid_ = -1, socket_ = -1;
};

// Repeats `part(done)`, a system call that reads or writes the bytes after the first `done`, until `bytes` are through;
// false where it fails or ends before.
template <class Part>
bool transfer(std::size_t bytes, Part part) {
  for (std::size_t done = 0; done < bytes;) {
    const std::ptrdiff_t more = part(done);
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) return false;
    done += static_cast<std::size_t>(more);
  }
  return true;
}

// Whole messages over a stream socket: the length, then the bytes. False where the other end is gone.
bool send_message(int socket, std::string_view bytes);
bool receive_message(int socket, std::string& bytes);

// Waits until there is something to read. `enough(wall)`, asked now and then with the seconds waited, ends the wait:
// false.
bool wait_for_message(int socket, double deadline, const std::function<bool(double wall)>& enough);

}  // namespace zwang
