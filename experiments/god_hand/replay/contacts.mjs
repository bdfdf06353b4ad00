// Contacts as arrows along their normals, as long as the push they hand on; drawn again, faintly, through everything.
import * as THREE from 'three';
import {contact_colors} from './palette.mjs';

const parts = {
  shaft: new THREE.CylinderGeometry(.0008, .0008, 1, 10).rotateX(Math.PI / 2).translate(0, 0, .5),
  tip: new THREE.ConeGeometry(.0024, .0065, 16).rotateX(Math.PI / 2).translate(0, 0, .0032),
  foot: new THREE.SphereGeometry(.002, 16, 12),
};

export function make_contacts(run) {
  const {start, numbers} = run.contacts, group = new THREE.Group();
  const most = Math.max(1, ...Array.from(start.slice(1), (end, frame) => end - start[frame]));
  const layers = [false, true].flatMap(through => Object.entries(parts).map(([kind, geometry]) => {
    const material = new THREE.MeshBasicMaterial(through ? {transparent: true, opacity: .45, depthTest: false, depthWrite: false} : {});
    const mesh = new THREE.InstancedMesh(geometry, material, most);
    mesh.setColorAt(0, new THREE.Color());
    mesh.frustumCulled = false;
    mesh.renderOrder = through ? 30 : 3;
    group.add(mesh);
    return {kind, mesh};
  }));

  const up = new THREE.Vector3(0, 0, 1), point = new THREE.Vector3(), normal = new THREE.Vector3(), turn = new THREE.Quaternion();
  const one = new THREE.Vector3(1, 1, 1), scale = new THREE.Vector3(), matrix = new THREE.Matrix4(), color = new THREE.Color();
  function show(frame) {
    // A row's gap is to first order, and of the row's sphere: whether anything is inside, the shapes say.
    const pierced = run.numbers.gap[frame] < 0;
    const count = start[frame + 1] - start[frame];
    for (let i = 0; i < count; i++) {
      const at = 8 * (start[frame] + i), inside = pierced && numbers[at + 6] < 0, push = numbers[at + 7];
      point.set(numbers[at], numbers[at + 1], numbers[at + 2]);
      normal.set(numbers[at + 3], numbers[at + 4], numbers[at + 5]);
      turn.setFromUnitVectors(up, normal);
      const length = inside || push > 1e-6 ? .026 + .034 * (1 - Math.exp(-push / 12)) : .012;
      color.set(inside ? contact_colors.inside : push > 1e-6 ? contact_colors.push : contact_colors.near);
      for (const {kind, mesh} of layers) {
        if (kind === 'shaft') matrix.compose(point, turn, scale.set(1, 1, length));
        else if (kind === 'tip') matrix.compose(scale.copy(normal).multiplyScalar(length).add(point), turn, one);
        else matrix.compose(point, turn, one);
        mesh.setMatrixAt(i, matrix);
        mesh.setColorAt(i, color);
      }
    }
    for (const {mesh} of layers) {
      mesh.count = count;
      mesh.instanceMatrix.needsUpdate = mesh.instanceColor.needsUpdate = true;
    }
  }
  return {group, show};
}
