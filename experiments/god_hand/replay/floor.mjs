// A grid that fades out around the work, and the shadows that fall beside the objects.
import * as THREE from 'three';

const fragment = `
  uniform vec3 color, line;
  uniform float strength, reach;
  uniform vec2 centre;
  varying vec2 at;
  float grid(float step) {
    vec2 g = at / step, d = abs(fract(g - .5) - .5) / fwidth(g);
    return 1. - min(min(d.x, d.y), 1.);
  }
  void main() {
    float far = length(at - centre) / reach, fade = pow(clamp(1. - far, 0., 1.), 1.5);
    float on = max(.45 * grid(.02) * clamp(1. - 3. * far, 0., 1.), grid(.1)) * strength;
    gl_FragColor = vec4(mix(color, line, on), fade * mix(.55, 1., on));
    #include <colorspace_fragment>
  }`;

export function make_floor(height, centre, reach) {
  const group = new THREE.Group();
  const uniforms = {color: {value: new THREE.Color()}, line: {value: new THREE.Color()}, strength: {value: 1}, reach: {value: reach}, centre: {value: new THREE.Vector2(centre.x, centre.y)}};
  const plane = new THREE.PlaneGeometry(2 * reach, 2 * reach);
  const grid = new THREE.Mesh(plane, new THREE.ShaderMaterial({
    uniforms, fragmentShader: fragment, transparent: true, depthWrite: false, side: THREE.DoubleSide,
    vertexShader: 'varying vec2 at; void main() { vec4 p = modelMatrix * vec4(position, 1.); at = p.xy; gl_Position = projectionMatrix * viewMatrix * p; }',
  }));
  const shadow = new THREE.Mesh(plane, new THREE.ShadowMaterial({depthWrite: false}));
  shadow.receiveShadow = true;
  grid.renderOrder = -2;
  shadow.renderOrder = -1;
  group.add(grid, shadow);
  group.position.set(centre.x, centre.y, height);
  return {group, set_theme({floor, grid: line, grid_strength, shadow: dark}) {
    uniforms.color.value.set(floor);
    uniforms.line.value.set(line);
    uniforms.strength.value = grid_strength;
    shadow.material.opacity = dark;
  }};
}
