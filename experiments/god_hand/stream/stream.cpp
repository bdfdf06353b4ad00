#include <zwang/experiments/god_hand/stream/stream.h>

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <zwang/core/problem/wording.h>

namespace zwang::god {
namespace {

constexpr int room = 1 << 20;  // bytes that a reader may lag behind

template <class Part>
void append(std::vector<unsigned char>& out, const Part& part) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(&part);
  out.insert(out.end(), bytes, bytes + sizeof part);
}

// Bytes that had room, at once; 0: none; below 0: the other side has gone.
ssize_t put(int socket, std::span<const unsigned char> bytes) {
  if (bytes.empty()) return 0;
  const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  const bool later = errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS || errno == EINTR;
  return sent < 0 && later ? 0 : sent;
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
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

Stream::Stream(const Place& place, std::size_t bodies, Say say) : bodies_(bodies), say_(std::move(say)) {
  if (place.address.empty() || !place.socket.empty()) listen_at(place.socket);
  if (!place.address.empty()) listen_on(place.address);
}

void Stream::fail(const std::string& where, const std::string& why) {
  close_all();
  throw std::invalid_argument(where + ": " + why);
}

void Stream::listen_at(const std::string& path) {
  const std::string name = "socket '" + path + "'";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    fail(name, "a path of 1 to " + std::to_string(sizeof address.sun_path - 1) + " bytes is expected");
  std::memcpy(address.sun_path, path.data(), path.size());
  const auto* at = reinterpret_cast<const sockaddr*>(&address);
  const int probe = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  const int answer = connect(probe, at, sizeof address), error = errno;
  close(probe);
  if (answer == 0) fail(name, "another program listens there");
  if (error == ECONNREFUSED && std::filesystem::is_socket(path)) unlink(path.c_str());
  local_ = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (local_ < 0 || bind(local_, at, sizeof address) != 0 || listen(local_, 16) != 0) fail(name, std::strerror(errno));
  where_ = path_ = path;
}

void Stream::listen_on(const std::string& address) {
  const std::string name = "--listen " + address;
  const std::size_t colon = address.rfind(':');
  const std::string host = colon == std::string::npos ? "127.0.0.1" : address.substr(0, colon),
                    port = address.substr(colon + 1);  // npos + 1: from the beginning
  const std::optional<std::uint16_t> number = number_in<std::uint16_t>(port);
  if (!number) fail(name, "HOST:PORT, or a port from 0 to 65535, is expected");
  addrinfo hints{};
  hints.ai_family = AF_INET, hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int wrong = getaddrinfo(host.c_str(), nullptr, &hints, &found); wrong != 0) fail(name, gai_strerror(wrong));
  sockaddr_in place{};
  std::memcpy(&place, found->ai_addr, sizeof place);
  freeaddrinfo(found);
  place.sin_port = htons(*number);
  auto* at = reinterpret_cast<sockaddr*>(&place);
  socklen_t size = sizeof place;
  tcp_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int on = 1;  // a port whose last connections are not quite closed may be taken again
  setsockopt(tcp_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (tcp_ < 0 || bind(tcp_, at, size) != 0 || listen(tcp_, 16) != 0) fail(name, std::strerror(errno));
  getsockname(tcp_, at, &size);
  where_ += (where_.empty() ? "" : " and ") + host + ":" + std::to_string(ntohs(place.sin_port));
}

void Stream::close_all() {
  for (const Peer& peer : peers_) close(peer.socket);
  for (const int listener : {local_, tcp_})
    if (listener >= 0) close(listener);
  if (!path_.empty()) unlink(path_.c_str());
}

Stream::~Stream() { close_all(); }

void Stream::accept() {
  for (const int listener : {local_, tcp_})
    for (int s; listener >= 0 && (s = accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0;) {
      setsockopt(s, SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
      const int at_once = 1;
      if (listener == tcp_) setsockopt(s, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
      peers_.push_back({.socket = s, .whole = listener == local_, .in = {}});
      peers_.back().in.resize(sizeof(stream::Header) + bodies_ * sizeof(stream::Pose) + 1);
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
  const bool touches = std::ranges::any_of(frame.contacts, [](const auto& c) { return c.gap <= hand::touching; });
  h.flags = (frame.tracked ? tracked : 0u) | (frame.held ? held : 0u) | (touches ? touching : 0u);
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
    Peer& peer = peers_[p];
    ssize_t sent = put(peer.socket, peer.rest);
    if (sent > 0) peer.rest.erase(peer.rest.begin(), peer.rest.begin() + sent);
    if (sent >= 0 && peer.rest.empty()) {
      sent = put(peer.socket, out_);
      if (sent > 0) peer.rest.assign(out_.begin() + sent, out_.end());
    } else if (sent > 0) {
      sent = 0;
    }
    if (sent < 0) {
      drop(p, "has left");
      continue;
    }
    if (sent == 0) ++peer.missed, ++missed_;
    ++p;
  }
}

bool Stream::receive(std::vector<Pose<double>>& targets) {
  using namespace stream;
  accept();
  bool any = false;
  for (std::size_t p = 0; p < peers_.size();) {
    Peer& peer = peers_[p];
    const std::size_t whole = peer.in.size() - 1;
    // Of a local socket one byte more than is right, so that what is too long is seen.
    const ssize_t got = recv(peer.socket, peer.in.data() + peer.have, whole - peer.have + peer.whole, MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
      ++p;
      continue;
    }
    if (got <= 0) {
      drop(p, "has left");
      continue;
    }
    peer.have += static_cast<std::size_t>(got);
    Header h{};
    std::memcpy(&h, peer.in.data(), std::min(sizeof h, peer.have));
    const bool targets_for_us =
        h.magic == magic && h.version == version && h.kind == Kind::targets && h.bodies == bodies_;
    if (peer.whole ? peer.have != whole || !targets_for_us : peer.have >= sizeof h && !targets_for_us) {
      drop(p, "sent " + std::to_string(peer.have) + " bytes that are not targets for " + std::to_string(bodies_) +
                  " god objects (docs/stream.md): disconnected");
      continue;
    }
    if (peer.have < whole) continue;
    peer.have = 0;
    targets.resize(bodies_);
    for (std::size_t b = 0; b < bodies_; ++b) {
      stream::Pose pose{};
      std::memcpy(&pose, peer.in.data() + sizeof h + b * sizeof pose, sizeof pose);
      targets[b] = pose_of(pose);
    }
    answers_ = h.number;
    any = true;
  }
  return any;
}

}  // namespace zwang::god
