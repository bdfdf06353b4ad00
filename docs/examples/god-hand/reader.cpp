// Reads the frames of `./zwang live SCENE --socket PATH` and says once a second what came; needs no library.
//   reader PATH [SECONDS]           read
//   reader PATH SECONDS lower       and send poses: all god objects 170 mm down and up again
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

#include <zwang/experiments/god_hand/stream/message.h>

using namespace zwang::god::stream;

static std::int64_t now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1000000000ll * t.tv_sec + t.tv_nsec;
}

// Connects, waiting for the other side to be there. -1: not until `end`.
static int connect_to(const char* path, std::int64_t end) {
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  std::strncpy(at.sun_path, path, sizeof at.sun_path - 1);
  while (now() < end) {
    const int s = socket(AF_UNIX, SOCK_SEQPACKET, 0);
    if (s >= 0 && connect(s, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0) return s;
    if (s >= 0) close(s);
    usleep(20000);
  }
  return -1;
}

int main(int count, char** word) {
  if (count < 2) return std::puts("reader PATH [SECONDS [lower]]"), 2;
  const std::int64_t end = now() + static_cast<std::int64_t>(1e9 * (count > 2 ? std::atof(word[2]) : 1e6));
  const bool lower = count > 3;
  std::vector<unsigned char> message(1 << 20), targets;
  std::vector<double> late;  // us
  std::uint64_t last = 0, missing = 0, answered = 0;
  for (int s = connect_to(word[1], end); s >= 0; s = connect_to(word[1], end)) {
    bool first = true;
    std::vector<Pose> start;
    std::int64_t begin = now(), said = begin;
    while (now() < end) {
      const ssize_t got = recv(s, message.data(), message.size(), 0);
      if (got < static_cast<ssize_t>(sizeof(Header))) break;
      Header h{};
      std::memcpy(&h, message.data(), sizeof h);
      if (h.magic != magic || h.version != version || h.kind != Kind::frame)
        return std::puts("these are not frames of this version"), 3;
      late.push_back(1e-3 * static_cast<double>(now() - h.sent));
      if (!first) missing += h.number - last - 1;
      answered += h.answers > 0;
      last = h.number;
      std::vector<Body> body(h.bodies);
      std::memcpy(body.data(), message.data() + sizeof h, h.bodies * sizeof(Body));
      if (first)
        for (const Body& b : body) start.push_back(b.target);
      first = false;
      if (lower) {
        const double down = 0.085 * (1 - std::cos(2e-9 * static_cast<double>(now() - begin)));
        Header t{magic, version, Kind::targets, h.number, 0, now(), 0, h.bodies, 0, 0, 0, 0};
        std::vector<Pose> pose = start;
        for (Pose& p : pose) p.position[2] -= down;
        targets.resize(sizeof t + pose.size() * sizeof(Pose));
        std::memcpy(targets.data(), &t, sizeof t);
        std::memcpy(targets.data() + sizeof t, pose.data(), pose.size() * sizeof(Pose));
        send(s, targets.data(), targets.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
      }
      if (now() - said < 1000000000) continue;
      said = now();
      std::nth_element(late.begin(), late.begin() + static_cast<long>(late.size() / 2), late.end());
      std::printf("frame %llu: %zu came, %llu missing, %llu answers, %.0f us old (median), palm %.2f N\n",
                  static_cast<unsigned long long>(last), late.size(), static_cast<unsigned long long>(missing),
                  static_cast<unsigned long long>(answered), late[late.size() / 2],
                  std::hypot(body[0].force[0], body[0].force[1], body[0].force[2]));
      std::fflush(stdout);
      late.clear();
    }
    close(s);
    if (now() < end)
      std::printf("zwang has gone after frame %llu; waiting for it\n", static_cast<unsigned long long>(last));
    std::fflush(stdout);
  }
}
