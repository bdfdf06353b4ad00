// Geometries of rounded shapes (a convex core swept by a sphere) and of decoded meshes, in metres.
import * as THREE from 'three';
import {ConvexGeometry} from 'three/addons/geometries/ConvexGeometry.js';
import {RoundedBoxGeometry} from 'three/addons/geometries/RoundedBoxGeometry.js';
import {toCreasedNormals} from 'three/addons/utils/BufferGeometryUtils.js';

// The radius along which a sphere at each corner is replaced by points; their hull is the swept hull to 2 % of it.
const directions = (() => {
  const at = new THREE.IcosahedronGeometry(1, 2).attributes.position, seen = new Map();
  for (let i = 0; i < at.count; i++) {
    const v = new THREE.Vector3().fromBufferAttribute(at, i);
    seen.set(v.toArray().map(x => x.toFixed(4)).join(), v);
  }
  return [...seen.values()];
})();

function capsule([a, b], radius, round = 24) {
  const from = new THREE.Vector3(...a), axis = new THREE.Vector3(...b).sub(from), length = axis.length();
  const geometry = new THREE.CapsuleGeometry(radius, length, 10, round);
  geometry.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), length > 0 ? axis.clone().normalize() : new THREE.Vector3(0, 1, 0)));
  return geometry.translate(...from.addScaledVector(axis, .5).toArray());
}

export function shape_geometry({core, corners, radius}) {
  if (core === 'point') return new THREE.SphereGeometry(radius, 32, 24).translate(...corners[0]);
  if (core === 'segment') return capsule(corners, radius);
  if (core === 'box') {
    const box = new THREE.Box3().setFromPoints(corners.map(c => new THREE.Vector3(...c))).expandByScalar(radius);
    return new RoundedBoxGeometry(...box.getSize(new THREE.Vector3()).toArray(), 5, radius).translate(...box.getCenter(new THREE.Vector3()).toArray());
  }
  const points = corners.flatMap(c => directions.map(d => new THREE.Vector3(...c).addScaledVector(d, radius)));
  return toCreasedNormals(new ConvexGeometry(points), .5);
}

// Positions stay u16: the mesh's own scale and place undo it.
export function mesh_geometry(mesh) {
  const geometry = new THREE.BufferGeometry();
  geometry.setIndex(new THREE.BufferAttribute(mesh.index, 1));
  geometry.setAttribute('position', new THREE.InterleavedBufferAttribute(new THREE.InterleavedBuffer(mesh.positions, 6), 3, 0, true));
  geometry.setAttribute('normal', new THREE.InterleavedBufferAttribute(new THREE.InterleavedBuffer(mesh.normals, 4), 3, 0, true));
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  return geometry;
}
