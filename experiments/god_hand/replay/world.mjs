// The 3D view: objects, god hand, ghost, contacts, light, camera. z is up; metres.
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {make_contacts} from './contacts.mjs';
import {make_floor} from './floor.mjs';
import {hand_pixels, make_ghost} from './ghost.mjs';
import {themes} from './palette.mjs';
import {mesh_geometry, shape_geometry} from './shapes.mjs';

export const cameras = ['iso', 'front', 'side', 'top', 'close', 'scene'];
export const layers = {ghost: 'tracked hand', hand: 'god hand', contacts: 'contacts', objects: 'objects', xray: 'see through', follow: 'follow the hand'};

export function make_world(canvas, run, changed) {
  const renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true, stencil: true, powerPreference: 'high-performance'});
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = THREE.PCFShadowMap;
  const scene = new THREE.Scene();
  THREE.Object3D.DEFAULT_UP.set(0, 0, 1);
  const camera = new THREE.PerspectiveCamera(34, 1, .01, 60);
  camera.up.set(0, 0, 1);
  const orbit = new OrbitControls(camera, canvas);
  orbit.zoomToCursor = true;
  orbit.minDistance = .04;
  orbit.maxDistance = 12;

  // Objects. A fixed one stays where it is; a loose one is moved by show(). Two-sided, since parts may be open sheets or
  // wound inside out: a normal on the far side of its pixel's own plane is turned. By winding, as is usual, slivers that
  // simplification has folded over come out as black flecks.
  const two_sided = shader => {
    shader.fragmentShader = shader.fragmentShader.replace('#include <normal_fragment_begin>', THREE.ShaderChunk.normal_fragment_begin.replace(
      /float faceDirection = [^;]*;/, 'float faceDirection = dot(vNormal, cross(dFdx(vViewPosition), dFdy(vViewPosition))) < 0. ? -1. : 1.;'));
  };
  const unit_meshes = run.meshes.map(mesh_geometry);
  const objects = new THREE.Group(), loose = [], materials = [];
  run.objects.forEach((object, i) => {
    const material = new THREE.MeshStandardMaterial({roughness: .82, metalness: 0, side: THREE.DoubleSide});
    material.onBeforeCompile = two_sided;
    const group = new THREE.Group();
    const add = (geometry, place) => {
      const mesh = new THREE.Mesh(geometry, material);
      mesh.castShadow = mesh.receiveShadow = true;
      place(mesh);
      group.add(mesh);
    };
    if (object.mesh !== undefined) {
      const {low, size} = run.meshes[object.mesh];
      add(unit_meshes[object.mesh], mesh => (mesh.position.set(...low), mesh.scale.setScalar(size)));
    } else {
      for (const piece of object.pieces)
        add(shape_geometry(piece), mesh => (mesh.position.set(...piece.at.slice(0, 3)), mesh.quaternion.set(...piece.at.slice(3))));
    }
    group.position.set(...object.pose.slice(0, 3));
    group.quaternion.set(...object.pose.slice(3));
    objects.add(group);
    materials.push({material, loose: object.loose, order: object.loose ? loose.length : i - loose.length});
    if (object.loose) loose.push(group);
  });
  scene.add(objects);

  // Hands.
  const geometries = run.hands.flatMap(hand => hand.shapes.map(shape_geometry));
  const owner = run.hands.flatMap((hand, h) => hand.shapes.map((shape, i) => ({hand: h, palm: i === 0})));
  const skin = () => new THREE.MeshStandardMaterial({roughness: .46, metalness: 0, ...hand_pixels});
  const skins = run.hands.map(() => ({bone: skin(), palm: skin(), touch: skin(), inside: skin()}));
  const hand = new THREE.Group();
  const bodies = geometries.map(geometry => {
    const mesh = new THREE.Mesh(geometry);
    mesh.castShadow = mesh.receiveShadow = true;
    hand.add(mesh);
    return mesh;
  });
  const ghost = make_ghost(geometries), contacts = make_contacts(run);
  scene.add(hand, ghost.overlay, contacts.group);

  // Where the hand works: the box of its palm over the run, and how it points.
  const probe = new THREE.Object3D(), path = new THREE.Box3(), forward = new THREE.Vector3();
  for (let frame = 0; frame < run.frames; frame += Math.ceil(run.frames / 300))
    for (let body = 0; body < run.count; body += 3) {
      run.place(probe, frame, run.count + body);
      path.expandByPoint(probe.position);
      if (body === 0) forward.add(new THREE.Vector3(0, 1, 0).applyQuaternion(probe.quaternion));
    }
  forward.setZ(0);
  if (forward.length() < 1e-3) forward.set(0, 1, 0);
  forward.normalize();
  scene.updateMatrixWorld(true);
  const whole = new THREE.Box3().setFromObject(objects).union(path);
  const work = path.getCenter(new THREE.Vector3()), reach = Math.min(.5, Math.max(.15, path.getSize(new THREE.Vector3()).length() / 2 + .06));

  const floor = make_floor(whole.min.z - .0015, work, Math.max(1.2, whole.getSize(new THREE.Vector3()).length()));
  scene.add(floor.group);
  const sky = new THREE.HemisphereLight(0xffffff, 0xffffff, 1), sun = new THREE.DirectionalLight(0xffffff, 1), fill = new THREE.DirectionalLight(0xffffff, 1);
  const light = new THREE.Vector3(.45, -.35, 1).applyAxisAngle(new THREE.Vector3(0, 0, 1), Math.atan2(forward.y, forward.x) - Math.PI / 2);
  const lit = Math.min(1.2, Math.max(reach + .15, whole.getSize(new THREE.Vector3()).length() / 2));
  sun.position.copy(work).addScaledVector(light.normalize(), 2);
  sun.target.position.copy(work);
  fill.position.copy(work).add(new THREE.Vector3(-light.x, -light.y, .25));
  fill.target.position.copy(work);
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  Object.assign(sun.shadow.camera, {left: -lit, right: lit, top: lit, bottom: -lit, near: .2, far: 4});
  sun.shadow.bias = -3e-4;
  sun.shadow.normalBias = .0025;
  sun.shadow.radius = 3;
  scene.add(sky, sun, sun.target, fill, fill.target);

  const on = {ghost: true, hand: true, contacts: true, objects: true, xray: false, follow: false};
  let waiting = false, rendered = 0, shown = 0, followed = null;
  function draw() {
    waiting = false;
    if (on.follow) {
      const now = bodies[0].position.clone();
      if (followed) {
        camera.position.add(now).sub(followed);
        orbit.target.add(now).sub(followed);
        orbit.update();
      }
      followed = now;
    } else followed = null;
    if (on.ghost) ghost.draw(renderer, camera);
    renderer.render(scene, camera);
    ++rendered;
  }
  const soon = () => { if (!waiting) { waiting = true; requestAnimationFrame(draw); } };

  function show(frame) {
    shown = frame;
    for (let i = 0; i < run.count; i++) {
      run.place(ghost.bodies[i], frame, i);
      run.place(bodies[i], frame, run.count + i);
      bodies[i].material = skins[owner[i].hand][owner[i].palm ? 'palm' : 'bone'];
    }
    loose.forEach((group, k) => run.place(group, frame, 2 * run.count + k));
    const {start, numbers, who} = run.contacts;
    for (let k = start[frame]; k < start[frame + 1]; k++) {
      const body = who[2 * k], inside = run.numbers.gap[frame] < 0 && numbers[8 * k + 6] < 0;
      if (inside || (numbers[8 * k + 7] > 1e-6 && bodies[body].material !== skins[owner[body].hand].inside))
        bodies[body].material = skins[owner[body].hand][inside ? 'inside' : 'touch'];
    }
    contacts.show(frame);
    soon();
  }

  function set_layer(name, value) {
    on[name] = value;
    ghost.overlay.visible = on.ghost;
    hand.visible = on.hand;
    contacts.group.visible = on.contacts;
    objects.visible = on.objects;
    for (const {material} of materials) {
      Object.assign(material, {transparent: on.xray, opacity: on.xray ? .22 : 1, depthWrite: !on.xray});
      material.needsUpdate = true;
    }
    soon();
  }

  function set_theme(name) {
    const theme = themes[name];
    floor.set_theme(theme);
    sky.color.set(theme.sky);
    sky.groundColor.set(theme.earth);
    sky.intensity = theme.hemisphere;
    sun.intensity = theme.sun;
    fill.intensity = theme.fill;
    ghost.tint.value.set(theme.ghost);
    for (const {material, loose, order} of materials) {
      const colors = loose ? theme.loose : theme.fixed;
      material.color.set(colors[order % colors.length]);
    }
    skins.forEach((skin, h) => {
      const [bone, palm] = theme.hands[h % 2];
      skin.bone.color.set(bone);
      skin.palm.color.set(palm);
      skin.touch.color.set(theme.touch[h % 2]);
      skin.inside.color.set(0xe0522b);
    });
    soon();
  }

  // Distance from which a ball of this radius fills the smaller side of the view.
  const fit = radius => radius / Math.sin(THREE.MathUtils.degToRad(camera.fov / 2)) / Math.min(1, camera.aspect);
  function look(from, at, radius) {
    orbit.target.copy(at);
    camera.position.copy(at).addScaledVector(from.clone().normalize(), fit(radius));
    followed = null;
    orbit.update();
    soon();
  }
  const direction = (angle, height) => forward.clone().applyAxisAngle(new THREE.Vector3(0, 0, 1), angle).setZ(height);
  function aim(name) {
    if (name === 'iso') look(direction(-.85, .62), work, reach);
    if (name === 'front') look(direction(0, .22), work, reach);
    if (name === 'side') look(direction(-Math.PI / 2, .16), work, reach);
    if (name === 'top') look(direction(Math.PI, 30), work, reach);
    if (name === 'scene') look(direction(-.85, .7), whole.getCenter(new THREE.Vector3()), whole.getSize(new THREE.Vector3()).length() / 2);
    if (name === 'close') {
      const tips = new THREE.Box3().setFromPoints(bodies.slice(0, 16).map(body => body.position));
      look(direction(-.6, .3), tips.getCenter(new THREE.Vector3()), .095);
    }
  }
  const view = () => [...camera.position.toArray(), ...orbit.target.toArray()];
  function set_view(numbers) {
    camera.position.set(...numbers.slice(0, 3));
    orbit.target.set(...numbers.slice(3));
    followed = null;
    orbit.update();
    soon();
  }
  function resize() {
    const {clientWidth: width, clientHeight: height} = canvas.parentElement;
    if (width === 0 || height === 0) return;
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    soon();
  }
  orbit.addEventListener('change', soon);
  orbit.addEventListener('start', () => changed('camera'));
  orbit.addEventListener('end', () => changed('camera'));
  new ResizeObserver(resize).observe(canvas.parentElement);
  resize();
  return {show, draw, set_layer, set_theme, aim, view, set_view, layers: on, canvas, get rendered() { return rendered; }, get frame() { return shown; }};
}
