// What the page holds, as typed arrays (docs/god-hand.md, replay.cpp).
import {MeshoptDecoder} from 'meshopt_decoder';

function bytes(base64) {
  const text = atob(base64), out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) out[i] = text.charCodeAt(i);
  return out;
}
const floats = base64 => new Float32Array(bytes(base64).buffer);

// Positions as u16 steps over the mesh's box; normals unfolded from the octahedron.
function decode_mesh(mesh) {
  const raw = new Uint8Array(12 * mesh.vertices), index = new Uint8Array(4 * mesh.indices);
  MeshoptDecoder.decodeVertexBuffer(raw, mesh.vertices, 12, bytes(mesh.vertex_bytes));
  MeshoptDecoder.decodeIndexBuffer(index, mesh.indices, 4, bytes(mesh.index_bytes));
  const words = new Int16Array(raw.buffer), normals = new Int16Array(4 * mesh.vertices);
  for (let i = 0; i < mesh.vertices; i++) {
    let x = words[6 * i + 3] / 32767, y = words[6 * i + 4] / 32767;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
    const unit = 32767 / Math.hypot(x, y, z);
    normals.set([x * unit, y * unit, z * unit], 4 * i);
  }
  return {...mesh, positions: new Uint16Array(raw.buffer), normals, index: new Uint32Array(index.buffer)};
}

export function read_run() {
  const run = JSON.parse(document.getElementById('data').textContent);
  const positions = new Uint16Array(bytes(run.poses.positions).buffer), quaternions = new Int16Array(bytes(run.poses.quaternions).buffer);
  const bodies = run.hands.reduce((n, hand) => n + hand.shapes.length, 0);
  const loose = run.surroundings.objects.filter(object => object.loose).length;
  const stride = 2 * bodies + loose, {low, size} = run.poses;
  const words = of => { const index = new Uint16Array(bytes(of.index).buffer); return frame => of.words[index[frame]]; };
  const contacts = {start: new Uint32Array(bytes(run.contacts.start).buffer), numbers: floats(run.contacts.numbers), who: new Int16Array(bytes(run.contacts.who).buffer)};

  // Writes a pose into anything with a position and a quaternion. slot: targets, then god objects, then loose objects.
  const place = (thing, frame, slot) => {
    const k = frame * stride + slot;
    thing.position.set(low[0] + positions[3 * k] / 65535 * size, low[1] + positions[3 * k + 1] / 65535 * size, low[2] + positions[3 * k + 2] / 65535 * size);
    thing.quaternion.set(quaternions[4 * k], quaternions[4 * k + 1], quaternions[4 * k + 2], quaternions[4 * k + 3]).normalize();
  };
  return {
    ...run, bodies: run.bodies, count: bodies, loose, place, contacts,
    meshes: run.surroundings.meshes.map(decode_mesh), objects: run.surroundings.objects, focus: run.surroundings.focus,
    numbers: Object.fromEntries(Object.entries(run.numbers).map(([key, text]) => [key, floats(text)])),
    claimed: words(run.claimed), verified: words(run.verified), fault: words(run.fault),
  };
}

export const marks = {untracked: 1, returned: 2, behind: 4, held: 8, stuck: 16, wrong: 32};
