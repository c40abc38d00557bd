// The scene in three dimensions, from behind or above; the view may follow the camera.
import { dashes, dispose, dots, ego, ellipse, frameOf, headingOf, place, ribbon, roadGrid, vehicle } from "/scene_shapes.js";

const kPast = 150, kPredicted_s = 2, kCell_m = 5, kUsualHeight_m = 1.65;

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class ScenePanel {
  constructor(element, onChoose) {
    this.element = element;
    this.labels = new Map();
    this.follow = true;
    this.dark = window.matchMedia("(prefers-color-scheme: dark)");
    this.scene = new THREE.Scene();
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    element.append(this.renderer.domElement);
    this.camera = new THREE.PerspectiveCamera(42, 1, 0.5, 1200);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8899aa, 1));
    this.orbit = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    Object.assign(this.orbit, { enableKeys: false, screenSpacePanning: false, maxPolarAngle: 1.5, minDistance: 4, maxDistance: 300 });
    this.orbit.addEventListener("change", () => this.render());
    this.road = null;
    this.addGrid();
    this.dark.addEventListener("change", () => { this.addGrid(); if (this.frame) this.show(this.frame, this.past, this.chosen, this.extra); });
    this.listen(onChoose);
    new ResizeObserver(() => this.resize()).observe(element);
  }

  listen(onChoose) {
    let down = null;
    this.element.addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; }, true);
    this.element.addEventListener("pointerup", (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 5) onChoose(this.objectAt(event));
      down = null;
    }, true);
    this.element.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.08], ArrowDown: [0, 0.08] }[event.key];
    const zoom = { "+": 0.88, "=": 0.88, "-": 1.14 }[event.key];
    if (!turn && !zoom) return;
    event.preventDefault();
    event.stopPropagation();
    const offset = this.camera.position.clone().sub(this.orbit.target);
    const s = new THREE.Spherical().setFromVector3(offset);
    if (turn) { s.theta += turn[0]; s.phi = Math.min(Math.max(s.phi + turn[1], 0.02), 1.5); }
    if (zoom) s.radius = Math.min(Math.max(s.radius * zoom, 4), 300);
    this.camera.position.copy(this.orbit.target).add(new THREE.Vector3().setFromSpherical(s));
    this.orbit.update();
    this.render();
  }

  addGrid() {
    if (this.grid) { this.scene.remove(this.grid); dispose(this.grid); }
    this.grid = roadGrid(kCell_m, css("--grid"));
    this.grid.visible = this.road !== null;
    this.scene.add(this.grid);
  }

  color(object) { return new THREE.Color(object.color).multiplyScalar(this.dark.matches ? 1 : 0.74); }

  setCamera(camera) { this.rig = camera; }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  // The road below a position, as last seen.
  below(p, lift = 0) {
    const { point, up } = this.road;
    const y = point.y - (up.x * (p.x - point.x) + up.z * (p.z - point.z)) / up.y;
    return new THREE.Vector3(p.x, y + lift, p.z);
  }

  setRoad(frame) {
    const at = place([frame.T[3], frame.T[7], frame.T[11]]);
    if (frame.road) this.road = { point: place(frame.road.point), up: place(frame.road.up), seen: true };
    else if (this.road) this.road.point = this.below(at);
    else this.road = { point: at.setY(at.y - kUsualHeight_m), up: new THREE.Vector3(0, 1, 0), seen: false };
    const { up } = this.road;
    this.grid.visible = this.road.seen;
    this.grid.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), up);
    this.grid.position.copy(this.below(at, -0.03));
    this.grid.material.uniforms.eye.value.copy(at);
  }

  // `extra` has the true path and another run's as lists of x, y, z of the world, both up to about now, and the other
  // run's frame; each may be missing.
  show(frame, past, chosen, extra = {}) {
    Object.assign(this, { frame, past, chosen, extra });
    this.setRoad(frame);
    const group = new THREE.Group();
    const colors = { accent: new THREE.Color(css("--accent")) };
    const at = this.below(place([frame.T[3], frame.T[7], frame.T[11]]), 0.05);
    group.add(ego(frame.T, at, this.rig, colors));
    const way = past.slice(-600).map(({ T }) => this.below(place([T[3], T[7], T[11]]), 0.02));
    if (way.length > 1) group.add(ribbon(way, 0.3, colors.accent, 0.7));
    for (const object of frame.objects) this.addObject(group, object);
    this.addPoints(group);
    this.addTruth(group);
    this.addOther(group);
    if (this.content) { this.scene.remove(this.content); dispose(this.content); }
    this.content = group;
    this.scene.add(group);
    this.moveWith(at, headingOf(frame.T));
    this.render();
  }

  addObject(group, object) {
    const color = this.color(object), center = place(object.center);
    group.add(vehicle(object, color, object.id === this.chosen));
    if (object.center_covariance_xz) group.add(ellipse(this.below(center, 0.06), object.center_covariance_xz, color));
    const way = [];
    for (const { objects } of this.past.slice(-kPast)) {
      const then = objects.find(({ id }) => id === object.id);
      if (then) way.push(this.below(place(then.center), 0.04));
    }
    if (way.length > 1) group.add(ribbon(way, 0.16, color, 0.85));
    if (object.state !== "stopped" && object.speed > 0.5) group.add(dots(this.predicted(object, center), 0.17, 0.85, color));
  }

  onRoad(path, lift) {
    const points = [];
    for (let i = 0; i + 2 < path.length; i += 3) points.push(this.below(place(path.slice(i, i + 3)), lift));
    return points;
  }

  addTruth(group) {
    const { true_path } = this.extra, ink = new THREE.Color(css("--ink"));
    if (!true_path) return;
    if (true_path.length > 3) group.add(dashes(this.onRoad(true_path, 0.08), ink));
    for (const object of this.frame.truth?.objects ?? []) group.add(frameOf(object, ink, { dashed: true, opacity: object.moving ? 1 : 0.4 }));
  }

  addOther(group) {
    const { other, other_path } = this.extra, color = new THREE.Color(css("--second"));
    if (other_path?.length > 3) group.add(ribbon(this.onRoad(other_path, 0.03), 0.16, color, 0.9));
    for (const object of other?.objects ?? []) group.add(frameOf(object, color));
  }

  // Extrapolates at constant speed and yaw rate.
  predicted(object, center) {
    const v = place(object.velocity), points = [this.below(center, 0.05)], step = 0.1;
    const up = place([object.T[2], object.T[6], object.T[10]]).normalize(), p = center.clone();
    for (let t = step; t <= kPredicted_s + 1e-6; t += step) {
      v.applyAxisAngle(up, object.yaw_rate * step);
      p.addScaledVector(v, step);
      points.push(this.below(p, 0.05));
    }
    return points;
  }

  addPoints(group) {
    const colors = new Map(this.frame.objects.map((object) => [object.id, this.color(object)]));
    const positions = [], shades = [], white = new THREE.Color(this.dark.matches ? "#ffffff" : "#000000");
    for (const [id, , , x, y, z] of this.frame.points ?? []) {
      const color = (colors.get(id) ?? white).clone().lerp(white, 0.4);
      positions.push(x, -y, -z);
      shades.push(color.r, color.g, color.b);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
    geometry.setAttribute("color", new THREE.Float32BufferAttribute(shades, 3));
    group.add(new THREE.Points(geometry, new THREE.PointsMaterial({ size: 3, sizeAttenuation: false, vertexColors: THREE.VertexColors })));
  }

  // The eye keeps its position relative to the followed camera.
  moveWith(at, heading) {
    if (!this.pose) {
      this.pose = { at, heading };
      return this.look("behind");
    }
    if (this.follow) {
      const axis = new THREE.Vector3(0, 1, 0);
      let turn = heading - this.pose.heading;
      turn = Math.atan2(Math.sin(turn), Math.cos(turn));
      for (const p of [this.camera.position, this.orbit.target]) p.sub(this.pose.at).applyAxisAngle(axis, turn).add(at);
      this.orbit.update();
    }
    this.pose = { at, heading };
  }

  look(from) {
    if (!this.pose) return;
    const tall = this.element.clientHeight > 1.2 * this.element.clientWidth;
    const [eye, target] = from === "above" ? [[0, tall ? 82 : 62, -19.9], [0, 0, -20]] : [[0, tall ? 15 : 12.5, tall ? 22 : 17], [0, 0, tall ? -13 : -14]];
    const axis = new THREE.Vector3(0, 1, 0);
    this.camera.position.set(...eye).applyAxisAngle(axis, this.pose.heading).add(this.pose.at);
    this.orbit.target.set(...target).applyAxisAngle(axis, this.pose.heading).add(this.pose.at);
    this.orbit.update();
    this.render();
  }

  objectAt(event) {
    if (!this.content) return null;
    const box = this.element.getBoundingClientRect();
    const ray = new THREE.Raycaster();
    ray.setFromCamera({ x: 2 * (event.clientX - box.left) / box.width - 1, y: 1 - 2 * (event.clientY - box.top) / box.height }, this.camera);
    const hit = ray.intersectObjects(this.content.children, true).find(({ object }) => object.userData.object !== undefined);
    return hit ? hit.object.userData.object : null;
  }

  render() {
    if (this.due) return;
    this.due = requestAnimationFrame(() => {
      this.due = 0;
      this.renderer.render(this.scene, this.camera);
      this.placeLabels();
    });
  }

  // Nearest first; a label that would cover another is left out.
  placeLabels() {
    const used = new Set(), taken = [], { clientWidth: width, clientHeight: height } = this.element;
    const eye = this.camera.position;
    const objects = [...(this.frame?.objects ?? [])].sort((a, b) => (b.id === this.chosen) - (a.id === this.chosen) ||
      place(a.center).distanceToSquared(eye) - place(b.center).distanceToSquared(eye));
    for (const object of objects) {
      const top = place(object.center);
      top.y += 0.5 * (object.cuboid ? object.cuboid.size[2] : 1.5) + 0.3;
      top.project(this.camera);
      if (top.z > 1 || Math.abs(top.x) > 1 || Math.abs(top.y) > 1) continue;
      const label = this.label(object), wide = label.offsetWidth, tall = label.offsetHeight;
      const x = Math.min(Math.max((top.x + 1) / 2 * width - wide / 2, 4), width - wide - 4), y = (1 - top.y) / 2 * height - tall - 4;
      const hidden = y < 46 || taken.some(([a, b, w]) => x < a + w + 3 && a < x + wide + 3 && y < b + tall + 2 && b < y + tall + 2);
      label.style.visibility = hidden ? "hidden" : "visible";
      if (!hidden) taken.push([x, y, wide]);
      label.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
      used.add(object.id);
    }
    for (const [id, label] of this.labels) if (!used.has(id)) { label.remove(); this.labels.delete(id); }
  }

  label(object) {
    let label = this.labels.get(object.id);
    if (!label) {
      label = document.createElement("div");
      label.className = "label";
      label.style.borderLeftColor = object.color;
      this.element.append(label);
      this.labels.set(object.id, label);
    }
    label.textContent = `#${object.id}  ${object.speed.toFixed(1)} m/s`;
    label.classList.toggle("chosen", object.id === this.chosen);
    return label;
  }
}
