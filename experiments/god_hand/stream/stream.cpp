#include <zwang/experiments/god_hand/stream/stream.h>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include <zwang/core/problem/wording.h>

namespace zwang::god {
namespace {

constexpr int room = 1 << 20;  // bytes that a reader may lag behind

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    throw std::invalid_argument("socket '" + path + "': a path of 1 to " + std::to_string(sizeof address.sun_path - 1) +
                                " bytes is expected");
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

template <class Part>
void append(std::vector<unsigned char>& out, const Part& part) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(&part);
  out.insert(out.end(), bytes, bytes + sizeof part);
}

void copy(const Vec3& v, double (&to)[3]) { std::copy_n(v.data(), 3, to); }

stream::Pose message_of(const Pose<double>& pose) {
  stream::Pose out{};
  const Eigen::Quaterniond q(pose.rotation);
  copy(pose.position, out.position);
  std::copy_n(q.coeffs().data(), 4, out.quaternion);
  return out;
}

Pose<double> pose_of(const stream::Pose& p) {
  const double* q = p.quaternion;
  return {{p.position[0], p.position[1], p.position[2]},
          Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix()};
}

}  // namespace

std::int64_t monotonic_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{1000000000} * now.tv_sec + now.tv_nsec;
}

Stream::Stream(std::string path, std::size_t bodies, Say say)
    : path_(std::move(path)), bodies_(bodies), say_(std::move(say)) {
  const sockaddr_un address = address_of(path_);
  const auto* at = reinterpret_cast<const sockaddr*>(&address);
  const auto fail = [&](const std::string& why) {
    if (listener_ >= 0) close(listener_);
    throw std::invalid_argument("socket '" + path_ + "': " + why);
  };
  const int probe = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  const int answer = connect(probe, at, sizeof address), error = errno;
  close(probe);
  if (answer == 0) fail("another program listens there");
  if (error == ECONNREFUSED) unlink(path_.c_str());
  listener_ = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (listener_ < 0 || bind(listener_, at, sizeof address) != 0 || listen(listener_, 16) != 0)
    fail(std::strerror(errno));
  in_.resize(sizeof(stream::Header) + bodies * sizeof(stream::Pose) + 1);
}

Stream::~Stream() {
  for (const Peer& peer : peers_) close(peer.socket);
  close(listener_);
  unlink(path_.c_str());
}

void Stream::accept() {
  for (int s; (s = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0;) {
    setsockopt(s, SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
    peers_.push_back({s, 0});
    say_("a reader is there from frame " + std::to_string(last_) + " on");
  }
}

void Stream::drop(std::size_t peer, const std::string& why) {
  say_("a reader " + why + " at frame " + std::to_string(last_) + ", which missed " +
       counted(peers_[peer].missed, "frame"));
  close(peers_[peer].socket);
  peers_.erase(peers_.begin() + static_cast<long>(peer));
}

void Stream::write(const Frame& frame) {
  using namespace stream;
  const std::size_t contacts = std::min<std::size_t>(frame.contacts.size(), most_contacts);
  Header h{};
  h.magic = magic, h.version = version, h.kind = Kind::frame;
  h.number = static_cast<std::uint64_t>(frame.number), h.time = frame.time, h.answers = answers_;
  h.bodies = static_cast<std::uint32_t>(frame.god.size()), h.loose = static_cast<std::uint32_t>(frame.loose.size());
  h.contacts = static_cast<std::uint32_t>(contacts);
  h.flags = (frame.tracked ? tracked : 0u) | (frame.held ? held : 0u) | (frame.touches() ? touching : 0u);
  h.sent = monotonic_ns();
  out_.clear();
  append(out_, h);
  for (std::size_t b = 0; b < frame.god.size(); ++b) {
    Body body{message_of(frame.god[b]), message_of(frame.target[b]), {}, {}};
    copy(frame.device[b].head<3>(), body.force);
    copy(frame.device[b].tail<3>(), body.torque);
    append(out_, body);
  }
  for (const zwang::Pose<double>& pose : frame.loose) append(out_, message_of(pose));
  for (std::size_t k = 0; k < contacts; ++k) {
    const FrameContact& c = frame.contacts[k];
    Contact out{c.body, c.object, {}, {}, c.gap, c.push};
    copy(c.point, out.point);
    copy(c.normal, out.normal);
    append(out_, out);
  }
}

void Stream::send(const Frame& frame) {
  last_ = static_cast<std::uint64_t>(frame.number);
  accept();
  if (peers_.empty()) return;
  write(frame);
  for (std::size_t p = 0; p < peers_.size();) {
    const ssize_t sent = ::send(peers_[p].socket, out_.data(), out_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != ENOBUFS && errno != EINTR) {
      drop(p, "has left");
      continue;
    }
    if (sent < 0) ++peers_[p].missed, ++missed_;
    ++p;
  }
}

bool Stream::receive(std::vector<Pose<double>>& targets) {
  using namespace stream;
  accept();
  bool any = false;
  for (std::size_t p = 0; p < peers_.size();) {
    const ssize_t got = recv(peers_[p].socket, in_.data(), in_.size(), MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
      ++p;
      continue;
    }
    if (got <= 0) {
      drop(p, "has left");
      continue;
    }
    Header h{};
    std::memcpy(&h, in_.data(), std::min(sizeof h, static_cast<std::size_t>(got)));
    if (static_cast<std::size_t>(got) != in_.size() - 1 || h.magic != magic || h.version != version ||
        h.kind != Kind::targets || h.bodies != bodies_) {
      drop(p, "sent " + std::to_string(got) + " bytes that are not targets for " + std::to_string(bodies_) +
                  " god objects (docs/stream.md): disconnected");
      continue;
    }
    targets.resize(bodies_);
    for (std::size_t b = 0; b < bodies_; ++b) {
      stream::Pose pose{};
      std::memcpy(&pose, in_.data() + sizeof h + b * sizeof pose, sizeof pose);
      targets[b] = pose_of(pose);
    }
    answers_ = h.number;
    any = true;
  }
  return any;
}

}  // namespace zwang::god
