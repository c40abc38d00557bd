// Shapes of the scene in three.js' axes: x right, y up, z back, where the run's world has x right, y down, z ahead.

export const place = (p) => new THREE.Vector3(p[0], -p[1], -p[2]);

// A flat band along a line, as WebGL draws no wide lines.
export function ribbon(points, width, color, opacity = 1) {
  const positions = [], index = [];
  for (let i = 0; i < points.length; ++i) {
    const before = points[Math.max(i - 1, 0)], after = points[Math.min(i + 1, points.length - 1)];
    let dx = after.x - before.x, dz = after.z - before.z;
    const length = Math.hypot(dx, dz) || 1;
    dx *= width / 2 / length;
    dz *= width / 2 / length;
    positions.push(points[i].x - dz, points[i].y, points[i].z + dx, points[i].x + dz, points[i].y, points[i].z - dx);
    if (i > 0) index.push(2 * i - 2, 2 * i - 1, 2 * i, 2 * i - 1, 2 * i + 1, 2 * i);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setIndex(index);
  return new THREE.Mesh(geometry, flat(color, opacity));
}

function flat(color, opacity) {
  return new THREE.MeshBasicMaterial({ color, transparent: opacity < 1, opacity, side: THREE.DoubleSide, depthWrite: opacity === 1 });
}

// Discs along a line, a fixed distance apart.
export function dots(points, radius, gap, color) {
  const group = new THREE.Group();
  const geometry = new THREE.CircleBufferGeometry(radius, 12).rotateX(-Math.PI / 2);
  let left = gap;
  for (let i = 1; i < points.length; ++i) {
    const step = points[i].distanceTo(points[i - 1]);
    for (let at = left; at <= step; at += gap) {
      const disc = new THREE.Mesh(geometry, flat(color, 1));
      disc.position.lerpVectors(points[i - 1], points[i], at / step);
      group.add(disc);
      left = at + gap;
    }
    left -= step;
  }
  return group;
}

// Two-sigma ellipse of a position on the ground, from the covariance of x and z in the run's world.
export function ellipse(center, [xx, xz, zz], color) {
  const mean = (xx + zz) / 2, spread = Math.hypot((xx - zz) / 2, xz);
  const major = 2 * Math.sqrt(Math.max(mean + spread, 0)), minor = 2 * Math.sqrt(Math.max(mean - spread, 0));
  const angle = 0.5 * Math.atan2(2 * xz, xx - zz);
  const points = [];
  for (let i = 0; i <= 48; ++i) {
    const a = major * Math.cos(i * Math.PI / 24), b = minor * Math.sin(i * Math.PI / 24);
    points.push(new THREE.Vector3(center.x + a * Math.cos(angle) - b * Math.sin(angle), center.y,
      center.z - (a * Math.sin(angle) + b * Math.cos(angle))));
  }
  const group = new THREE.Group();
  group.add(ribbon(points, 0.07, color, 0.9));
  const fan = new THREE.BufferGeometry().setFromPoints(points.slice(1).flatMap((point, i) => [center, points[i], point]));
  group.add(new THREE.Mesh(fan, flat(color, 0.14)));
  return group;
}

function rotationOf(T) {
  const flip = [1, -1, -1], m = new THREE.Matrix4();
  const value = (row, column) => flip[row] * T[4 * row + column];
  m.set(value(0, 0), value(0, 1), value(0, 2), 0, value(1, 0), value(1, 1), value(1, 2), 0,
    value(2, 0), value(2, 1), value(2, 2), 0, 0, 0, 0, 1);
  return new THREE.Quaternion().setFromRotationMatrix(m);
}

// The cuboid, solid below and with its edges; hit by the pointer.
export function vehicle(object, color, chosen) {
  const size = object.cuboid ? object.cuboid.size : [4, 1.8, 1.5];
  const group = new THREE.Group();
  const box = new THREE.BoxBufferGeometry(size[0], size[1], size[2]);
  const faded = object.state === "predicted" ? 0.16 : 0.5;
  const body = new THREE.Mesh(box, new THREE.MeshLambertMaterial({ color, transparent: true, opacity: chosen ? 0.8 : faded }));
  body.userData.object = object.id;
  group.add(body);
  group.add(new THREE.LineSegments(new THREE.EdgesGeometry(box), new THREE.LineBasicMaterial({ color })));
  const nose = new THREE.Mesh(new THREE.ConeBufferGeometry(0.3 * size[1], 0.5 * size[1], 3), flat(color, 1));
  nose.rotation.z = -Math.PI / 2;
  nose.scale.z = 0.1;
  nose.position.set(size[0] / 2 + 0.4 * size[1], 0, 0.05 - size[2] / 2);
  group.add(nose);
  const turned = rotationOf(object.T);
  const offset = object.cuboid ? new THREE.Vector3(...object.cuboid.center) : new THREE.Vector3();
  group.quaternion.copy(turned);
  group.position.copy(place([object.T[3], object.T[7], object.T[11]])).add(offset.applyQuaternion(turned));
  return group;
}

// The edges of an object's cuboid alone.
export function frameOf(object, color, { dashed = false, opacity = 1 } = {}) {
  const { size, center } = object.cuboid ?? { size: [4, 1.8, 1.5], center: [0, 0, 0] };
  const edges = new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(size[0], size[1], size[2]));
  const look = { color, transparent: opacity < 1, opacity };
  const lines = new THREE.LineSegments(edges, dashed ? new THREE.LineDashedMaterial({ ...look, dashSize: 0.3, gapSize: 0.2 }) : new THREE.LineBasicMaterial(look));
  if (dashed) lines.computeLineDistances();
  const turned = rotationOf(object.T), offset = new THREE.Vector3(...center);
  lines.quaternion.copy(turned);
  lines.position.copy(place([object.T[3], object.T[7], object.T[11]])).add(offset.applyQuaternion(turned));
  return lines;
}

export function dashes(points, color) {
  const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineDashedMaterial({ color, dashSize: 1, gapSize: 0.7 }));
  line.computeLineDistances();
  return line;
}

// A grid of lines on the road, fixed in the world, which fades away from the camera.
export function roadGrid(cell_m, color) {
  const material = new THREE.ShaderMaterial({
    transparent: true, depthWrite: false, side: THREE.DoubleSide, extensions: { derivatives: true },
    uniforms: { color: { value: new THREE.Color(color) }, eye: { value: new THREE.Vector3() } },
    vertexShader: `varying vec3 world;
      void main() { vec4 p = modelMatrix * vec4(position, 1.); world = p.xyz; gl_Position = projectionMatrix * viewMatrix * p; }`,
    fragmentShader: `varying vec3 world; uniform vec3 color, eye;
      float lines(vec2 at) { vec2 w = fwidth(at), d = abs(fract(at - .5) - .5) / w; return max(0., 1. - min(d.x, d.y) * .8) * clamp(.6 / max(w.x, w.y), 0., 1.); }
      void main() { float far = distance(world.xz, eye.xz);
        gl_FragColor = vec4(color, lines(world.xz / ${cell_m.toFixed(1)}) * clamp(1.15 - far / 110., 0., 1.)); }`,
  });
  return new THREE.Mesh(new THREE.PlaneBufferGeometry(300, 300).rotateX(-Math.PI / 2), material);
}

// The camera with its field of view on the ground.
export function ego(T, road, camera, colors) {
  const group = new THREE.Group();
  const shape = new THREE.Shape([[0, 2.1], [0.8, -1.3], [0, -0.8], [-0.8, -1.3]].map((p) => new THREE.Vector2(...p)));
  const arrow = new THREE.Mesh(new THREE.ShapeBufferGeometry(shape).rotateX(-Math.PI / 2), flat(colors.accent, 1));
  group.add(arrow);
  const half = 0.5 * camera.width / camera.fx, far = 50;
  const view = new THREE.BufferGeometry().setFromPoints(
    [[0, 0], [half * far, -far], [-half * far, -far]].map(([x, z]) => new THREE.Vector3(x, -0.02, z)));
  group.add(new THREE.Mesh(view, flat(colors.accent, 0.07)));
  group.position.copy(road);
  group.rotation.y = headingOf(T);
  return group;
}

// Angle about three.js' y axis, 0 if the camera looks along the run's z axis.
export const headingOf = (T) => Math.atan2(-T[2], T[10]);

export function dispose(group) {
  group.traverse((node) => {
    if (node.geometry) node.geometry.dispose();
    if (node.material) node.material.dispose();
  });
}
