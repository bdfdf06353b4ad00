#pragma once

#include <cstdint>

// What goes over the socket (docs/stream.md): numbers in the machine's order (little-endian), each member at a multiple
// of its size. Nothing else of zwang is needed to read it.
namespace zwang::god::stream {

inline constexpr std::uint32_t magic = 0x646f677a;  // "zgod"
inline constexpr std::uint16_t version = 1;
enum class Kind : std::uint16_t { frame = 1, targets = 2 };
enum Flag : std::uint32_t { tracked = 1, held = 2, touching = 4 };
inline constexpr std::uint32_t most_contacts = 512;  // of a frame; more are left out

struct Header {  // 64 bytes
  std::uint32_t magic;
  std::uint16_t version;
  Kind kind;
  std::uint64_t number;   // of the frame, one more each time; of targets: the sender's own
  double time;            // s, simulated
  std::int64_t sent;      // ns, CLOCK_MONOTONIC
  std::uint64_t answers;  // of a frame: the number of the targets that it follows; 0: none
  std::uint32_t bodies, loose, contacts, flags;
  std::uint64_t reserved;
};

struct Pose {
  double position[3];    // m, world
  double quaternion[4];  // x y z w
};

struct Body {
  Pose god, target;
  double force[3], torque[3];  // N, N m, world: what a device shows there, from the target toward the god object
};

struct Contact {
  std::int32_t body, object;  // god object; loose or fixed object of the scene, or -1 - other god object
  double point[3];            // m, world
  double normal[3];           // unit, toward the god object
  double gap;                 // m
  double push;                // N, on the object
};

static_assert(sizeof(Header) == 64 && sizeof(Pose) == 56 && sizeof(Body) == 160 && sizeof(Contact) == 72);

// A frame:  Header, Body[bodies], Pose[loose], Contact[contacts].
// Targets:  Header, Pose[bodies].

}  // namespace zwang::god::stream
