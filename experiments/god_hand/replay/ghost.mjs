// The tracked hand: drawn alone into a picture of its own, so that its overlapping bodies become one outline, then laid
// over the scene pixel by pixel at its own depth: full where it is in front, fainter where it is inside an object (not
// where it is behind the god hand, whose pixels are marked in the stencil). Plain translucent bodies add up at the joints,
// and what is inside an object, the part that matters, would be hidden.
// It stands 1.5 mm behind where it is (depth is nearly 1 - near / distance, near = 10 mm): where both hands are the same,
// the god hand alone is seen.
import * as THREE from 'three';

const rim_vertex = `
  varying vec3 n, e;
  void main() {
    vec4 p = modelViewMatrix * vec4(position, 1.);
    n = normalMatrix * normal;
    e = -p.xyz;
    gl_Position = projectionMatrix * p;
  }`;
const rim_fragment = `
  varying vec3 n, e;
  void main() {
    float rim = 1. - abs(dot(normalize(n), normalize(e)));
    gl_FragColor = vec4(1., 1., 1., mix(.16, .95, rim * rim));
  }`;
const lay_vertex = 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0., 1.); }';
const lay_fragment = `
  uniform sampler2D ghost, depth;
  uniform vec3 tint;
  uniform float strength, behind;
  varying vec2 at;
  void main() {
    float alpha = texture2D(ghost, at).a * strength;
    if (alpha < .004) discard;
    float d = texture2D(depth, at).x;
    gl_FragDepth = d + behind * (1. - d) * (1. - d);
    gl_FragColor = vec4(tint, alpha);
    #include <colorspace_fragment>
  }`;

export const hand_pixels = {stencilWrite: true, stencilRef: 1, stencilZPass: THREE.ReplaceStencilOp};

export function make_ghost(geometries) {
  const scene = new THREE.Scene(), overlay = new THREE.Group();
  const rim = new THREE.ShaderMaterial({vertexShader: rim_vertex, fragmentShader: rim_fragment, blending: THREE.NoBlending});
  const bodies = geometries.map(geometry => {
    const mesh = new THREE.Mesh(geometry, rim);
    scene.add(mesh);
    return mesh;
  });
  const picture = new THREE.WebGLRenderTarget(1, 1, {samples: 4, depthTexture: new THREE.DepthTexture(1, 1)});
  const tint = {value: new THREE.Color()};
  const lay = (strength, depthFunc, more) => {
    const quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), new THREE.ShaderMaterial({
      vertexShader: lay_vertex, fragmentShader: lay_fragment, transparent: true, depthWrite: false, depthFunc,
      uniforms: {ghost: {value: picture.texture}, depth: {value: picture.depthTexture}, tint, strength: {value: strength}, behind: {value: .0015 / .01}}, ...more,
    }));
    quad.frustumCulled = false;
    quad.renderOrder = 20;
    overlay.add(quad);
  };
  lay(1, THREE.LessEqualDepth);
  lay(.6, THREE.GreaterDepth, {stencilWrite: true, stencilRef: 1, stencilFunc: THREE.NotEqualStencilFunc});
  return {
    bodies, overlay, tint,
    draw(renderer, camera) {
      const size = renderer.getDrawingBufferSize(new THREE.Vector2());
      picture.setSize(size.x, size.y);
      const color = renderer.getClearColor(new THREE.Color()), alpha = renderer.getClearAlpha();
      renderer.setRenderTarget(picture);
      renderer.setClearColor(0, 0);
      renderer.clear();
      renderer.render(scene, camera);
      renderer.setRenderTarget(null);
      renderer.setClearColor(color, alpha);
    },
  };
}
