"use strict";
// The limb in space on a canvas: positions in m, z upwards. Knows nothing of logs.
const LimbView = (() => {
  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const add = (a, b, s = 1) => [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s];
  const norm = (a) => Math.hypot(a[0], a[1], a[2]);
  const unit = (a) => { const n = norm(a) || 1; return [a[0] / n, a[1] / n, a[2] / n]; };
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const finite = (p) => p && p.every(Number.isFinite);
  const mix = (a, b, s) => [0, 1, 2].map((i) => Math.round(a[i] + (b[i] - a[i]) * s));
  const rgb = (c, alpha = 1) => `rgba(${c[0]},${c[1]},${c[2]},${alpha})`;

  class View {
    // `colors` are triples of 0 to 255: page, ink, soft, limb, rigid, obstacle, region, object, trail.
    constructor(canvas, colors) {
      Object.assign(this, { canvas, colors, azimuth: -1.0, elevation: 0.35, zoom: 1, middle: [0, 0, 0], extent: 1 });
      canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        this.dragged = [event.clientX, event.clientY];
      });
      canvas.addEventListener("pointermove", (event) => {
        if (!this.dragged) return;
        const [x, y] = this.dragged;
        this.dragged = [event.clientX, event.clientY];
        this.turn((x - event.clientX) * 0.01, (event.clientY - y) * 0.01);
      });
      for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { this.dragged = null; });
      canvas.addEventListener("wheel", (event) => {
        if (!event.ctrlKey && !event.metaKey) return;
        event.preventDefault();
        this.scaled(Math.exp(-event.deltaY * 0.002));
      }, { passive: false });
      this.onChange = () => {};
      new ResizeObserver(() => { this.bounds = null; this.onChange(); }).observe(canvas);
    }

    // Looks at a box that holds these points.
    fit(points) {
      const seen = points.filter(finite);
      if (!seen.length) return;
      const low = [0, 1, 2].map((i) => seen.reduce((m, p) => Math.min(m, p[i]), Infinity));
      const high = [0, 1, 2].map((i) => seen.reduce((m, p) => Math.max(m, p[i]), -Infinity));
      this.middle = [0, 1, 2].map((i) => (low[i] + high[i]) / 2);
      this.extent = Math.max(norm(sub(high, low)), 1e-3);
      this.floor = low[2];
    }

    look(azimuth, elevation) {
      Object.assign(this, { azimuth, elevation, zoom: 1 });
      this.onChange();
    }

    turn(azimuth, elevation) {
      this.azimuth += azimuth;
      this.elevation = Math.max(-1.57, Math.min(1.57, this.elevation + elevation));
      this.onChange();
    }

    scaled(factor) {
      this.zoom = Math.max(0.3, Math.min(8, this.zoom * factor));
      this.onChange();
    }

    // Unit vector to the eye.
    toward() {
      const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
      return [ca * ce, sa * ce, se];
    }

    project(p) {
      const [x, y, z] = sub(p, this.middle);
      const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
      const right = -sa * x + ca * y;
      const ahead = -(ca * x + sa * y);
      const depth = ahead * ce - z * se;
      const up = z * ce + ahead * se;
      const scale = this.scale * this.distance / Math.max(this.distance + depth, this.extent * 0.05);
      return [this.width / 2 + right * scale, this.height / 2 - up * scale, depth, scale];
    }

    // `state`: solids, carried, body {line, radius}, and lines: seen, ghost, start, plan, trail; targets.
    draw(state) {
      const ratio = window.devicePixelRatio || 1;
      // Measured once a size: to measure lays out the page.
      const box = this.bounds || (this.bounds = this.canvas.getBoundingClientRect());
      const [w, h] = [Math.max(1, Math.round(box.width * ratio)), Math.max(1, Math.round(box.height * ratio))];
      if (this.canvas.width !== w || this.canvas.height !== h) Object.assign(this.canvas, { width: w, height: h });
      Object.assign(this, { width: box.width, height: box.height, distance: this.extent * 3 });
      this.scale = 0.92 * Math.min(box.width, box.height) / this.extent * this.zoom;
      const g = this.canvas.getContext("2d");
      this.g = g;
      g.setTransform(ratio, 0, 0, ratio, 0, 0);
      g.clearRect(0, 0, box.width, box.height);
      this.patches = [];
      this.grid();
      const [regions, obstacles] = [true, false].map((is_region) => state.solids.filter((solid) => Boolean(solid.region) === is_region));
      for (const solid of obstacles) this.solid(solid);
      for (const object of state.carried) this.object(object);
      if (state.body) this.limb(state.body);
      this.patches.sort((a, b) => b.depth - a.depth);
      for (const patch of this.patches) patch.draw();
      // A region inside a box shows through its walls.
      for (const solid of regions) this.solid(solid);
      if (state.start) this.line(state.start, rgb(this.colors.soft, 0.7), 1.5, [1, 3]);
      if (state.plan) this.line(state.plan, rgb(this.colors.soft, 0.8), 1.25, [4, 4]);
      if (state.ghost) this.line(state.ghost, rgb(this.colors.ink, 0.7), 1.5, [6, 4]);
      if (state.seen) this.line(state.seen, rgb(this.colors.limb), 4, []);
      if (state.trail) this.line(state.trail, rgb(this.colors.trail), 2, []);
      for (const target of state.targets) this.target(target);
      this.names(state.solids, state.carried, state.targets);
      this.axes();
    }

    // Names of solids and carried objects in a column beside the solids, in the order of their heights, each with a line to a place of the solid
    // that is seen. A ring ends the line where others hide all of it.
    names(solids, carried, targets) {
      const seen = (one) => {
        const box = one.shape && one.shape.box;
        if (!box) return { name: one.name, at: middle(one) };
        const clear = this.places(box).find((at) => !solids.some((other) => other !== one && !other.region && this.hides(other, at)));
        return { name: one.name, at: clear || box.center_m, hidden: !clear };
      };
      const middle = ({ shape, lines_m }) => {
        if (shape && shape.sphere) return shape.sphere.center_m;
        if (shape && shape.capsule) return add(shape.capsule.from_m, sub(shape.capsule.to_m, shape.capsule.from_m), 0.5);
        const points = lines_m.flat().filter(finite);
        return points.reduce((sum, p) => add(sum, p, 1 / points.length), [0, 0, 0]);
      };
      const places = [...solids.map(seen), ...carried].filter(({ name, at }) => name && finite(at));
      const marks = places.map(({ name, at, hidden }) => ({ name, hidden, mark: this.project(at) })).sort((a, b) => a.mark[1] - b.mark[1]);
      this.named = [];
      if (!marks.length) return;
      const g = this.g;
      Object.assign(g, { font: "12px system-ui, sans-serif", textBaseline: "middle", lineJoin: "round" });
      const half = Math.max(...marks.map(({ name }) => g.measureText(name).width)) / 2;
      // The column does not follow the limb.
      const across = [...solids.flatMap((one) => one.lines_m.flat()), ...targets.map((one) => one.at), ...carried.map((one) => one.at)].filter(finite).map((p) => this.project(p)[0]);
      const [left, right] = [Math.min(...across), Math.max(...across)];
      const side = this.width - right >= left ? 1 : -1;
      const beside = (side > 0 ? right : left) + side * (18 + half);
      const column = Math.max(half + 4, Math.min(this.width - half - 4, beside));
      const step = Math.min(16, (this.height - 20) / marks.length);
      let below = -Infinity;
      const pushed = marks.map(({ mark }) => (below = Math.max(mark[1], below + step)));
      const shift = pushed.reduce((sum, height, i) => sum + height - marks[i].mark[1], 0) / marks.length;
      const heights = pushed.map((height, i) => Math.max(10 + step * i, height - shift));
      let above = this.height - 10 + step;
      for (let i = heights.length - 1; i >= 0; i--) above = heights[i] = Math.min(heights[i], above - step);
      marks.forEach(({ name, hidden, mark: [x, y] }, i) => {
        const width = g.measureText(name).width / 2;
        const start = column - side * half;
        Object.assign(g, { strokeStyle: rgb(this.colors.ink, 0.55), fillStyle: rgb(this.colors.ink, 0.8), lineWidth: 0.8 });
        g.beginPath();
        g.moveTo(x, y);
        g.lineTo(start - side * 3, heights[i]);
        g.stroke();
        g.beginPath();
        g.arc(x, y, 2, 0, 2 * Math.PI);
        if (hidden) g.stroke(); else g.fill();
        const at = start + side * width;
        Object.assign(g, { textAlign: "center", lineWidth: 3, strokeStyle: rgb(this.colors.page, 0.8), fillStyle: rgb(this.colors.ink) });
        g.strokeText(name, at, heights[i]);
        g.fillText(name, at, heights[i]);
        this.named.push({ name, hidden, x: at, y: heights[i], half: width });
      });
    }

    // The middle of a box, then those of its faces and edges, and its corners: outer ones are seen more often.
    places({ center_m, half_axes_m }) {
      const signs = [-1, 0, 1].flatMap((a) => [-1, 0, 1].flatMap((b) => [-1, 0, 1].map((c) => [a, b, c])));
      const order = (sign) => sign.reduce((sum, one) => sum + Math.abs(one), 0);
      signs.sort((a, b) => order(a) - order(b));
      return signs.map((sign) => sign.reduce((at, one, axis) => add(at, half_axes_m[axis], 0.9 * one), center_m));
    }

    // Whether a solid stands between a place and the eye.
    hides({ shape }, at) {
      if (!shape) return false;
      const way = sub(add(this.middle, this.toward(), this.distance), at);
      if (!shape.box) {
        const { from_m, to_m, radius_m } = shape.capsule || { from_m: shape.sphere.center_m, to_m: shape.sphere.center_m, ...shape.sphere };
        const balls = Math.min(64, Math.ceil(norm(sub(to_m, from_m)) / radius_m) + 1);
        return Array.from({ length: balls }, (_, i) => sub(add(from_m, sub(to_m, from_m), i / Math.max(balls - 1, 1)), at)).some((ball) => {
          const along = dot(ball, way) / dot(way, way);
          return along > 0 && norm(add(ball, way, -along)) < radius_m;
        });
      }
      const { center_m, half_axes_m } = shape.box;
      let [from, to] = [0, 1];
      for (const half of half_axes_m) {
        const [start, step] = [dot(sub(at, center_m), half), dot(way, half)].map((along) => along / dot(half, half));
        // A way along the face stays on its side.
        const ends = Math.abs(step) < 1e-12 ? (Math.abs(start) < 1 ? [0, 1] : [1, 0]) : [-1, 1].map((face) => (face - start) / step).sort((a, b) => a - b);
        [from, to] = [Math.max(from, ends[0]), Math.min(to, ends[1])];
      }
      return to - from > 1e-6;
    }

    grid() {
      if (this.floor === undefined) return;
      const step = 10 ** Math.floor(Math.log10(this.extent / 3));
      const reach = Math.ceil(this.extent * 0.6 / step);
      const at = (i, j) => [Math.round(this.middle[0] / step) * step + i * step, Math.round(this.middle[1] / step) * step + j * step, this.floor];
      for (let i = -reach; i <= reach; i++) {
        this.line([at(i, -reach), at(i, reach)], rgb(this.colors.soft, 0.18), 0.75, []);
        this.line([at(-reach, i), at(reach, i)], rgb(this.colors.soft, 0.18), 0.75, []);
      }
    }

    line(points, style, width, dash) {
      const g = this.g;
      g.beginPath();
      let broken = true;
      for (const point of points) {
        if (!finite(point)) { broken = true; continue; }
        const [x, y] = this.project(point);
        if (broken) g.moveTo(x, y); else g.lineTo(x, y);
        broken = false;
      }
      Object.assign(g, { strokeStyle: style, lineWidth: width, lineJoin: "round", lineCap: "butt" });
      g.setLineDash(dash);
      g.stroke();
      g.setLineDash([]);
    }

    // A tube as silhouettes of its pieces, each with a gradient across.
    // Its ends are flat or round.
    tube(points, radii, color, round = false) {
      const seen = points.map((point) => this.project(point));
      const light = mix(color, [255, 255, 255], 0.45);
      const dark = mix(color, [0, 0, 0], 0.35);
      const normals = seen.map((_, i) => {
        const [a, b] = [seen[Math.max(0, i - 1)], seen[Math.min(seen.length - 1, i + 1)]];
        const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        const n = Math.hypot(dx, dy);
        return n > 1e-6 ? [-dy / n, dx / n] : [0, 1];
      });
      for (let i = 0; i < seen.length; i++) {
        const [x, y, depth, scale] = seen[i];
        const r = radii[i] * scale;
        const end = i === 0 || i === seen.length - 1;
        const turned = i > 0 && Math.hypot(x - seen[i - 1][0], y - seen[i - 1][1]) < 0.5 * r;
        if (end || turned) {
          if (end && !round && points.length > 1) this.cap(points, i, seen[i], normals[i], r, mix(color, [255, 255, 255], 0.25));
          else this.patches.push({ depth: depth + (end ? 1e-4 : 2e-4), draw: () => this.disc(x, y, r, light, color, dark) });
        }
        if (i === 0) continue;
        const [px, py, pd, ps] = seen[i - 1];
        if (Math.hypot(x - px, y - py) < 1e-3) continue;
        const [n, m] = [normals[i - 1], normals[i]];
        const q = radii[i - 1] * ps;
        this.patches.push({
          depth: (depth + pd) / 2,
          draw: () => {
            const g = this.g;
            const [cx, cy] = [(x + px) / 2, (y + py) / 2];
            const [nx, ny] = [(n[0] + m[0]) / 2, (n[1] + m[1]) / 2];
            const k = Math.max(r, q);
            // The light comes from above.
            const s = ny > 0 ? -1 : 1;
            const fill = g.createLinearGradient(cx + nx * k * s, cy + ny * k * s, cx - nx * k * s, cy - ny * k * s);
            fill.addColorStop(0, rgb(color));
            fill.addColorStop(0.3, rgb(light));
            fill.addColorStop(1, rgb(dark));
            g.beginPath();
            g.moveTo(px + n[0] * q, py + n[1] * q);
            g.lineTo(x + m[0] * r, y + m[1] * r);
            g.lineTo(x - m[0] * r, y - m[1] * r);
            g.lineTo(px - n[0] * q, py - n[1] * q);
            g.closePath();
            Object.assign(g, { fillStyle: fill, strokeStyle: fill, lineWidth: 0.8, lineJoin: "round" });
            g.fill();
            g.stroke();
          },
        });
      }
    }

    // A flat end: a circle seen at its angle.
    cap(points, index, [x, y, depth], [nx, ny], r, color) {
      const along = unit(sub(points[Math.max(1, index)], points[Math.max(1, index) - 1]));
      const toward = dot(along, this.toward());
      const open = Math.abs(toward);
      const faces = (index ? toward : -toward) > 0;
      this.patches.push({ depth: depth + (faces ? -1e-3 : 1e-3), draw: () => {
        const g = this.g;
        g.beginPath();
        g.ellipse(x, y, r, Math.max(r * open, 0.3), Math.atan2(ny, nx), 0, 2 * Math.PI);
        g.fillStyle = rgb(color);
        g.fill();
      } });
    }

    disc(x, y, r, light, color, dark) {
      const g = this.g;
      const fill = g.createRadialGradient(x - r * 0.3, y - r * 0.4, r * 0.1, x, y, Math.max(r, 0.5));
      fill.addColorStop(0, rgb(light));
      fill.addColorStop(0.6, rgb(color));
      fill.addColorStop(1, rgb(dark));
      g.beginPath();
      g.arc(x, y, Math.max(r, 0.5), 0, 2 * Math.PI);
      g.fillStyle = fill;
      g.fill();
    }

    // Parts are divided where two points coincide; those of two points are rigid.
    limb({ line, radius }) {
      if (line.length < 2 || !line.every(finite)) return;
      const along = unit(sub(line[1], line[0]));
      const plate = Math.max(radius[0] * 1.5, 0.01);
      this.tube([add(line[0], along, -0.012), line[0]], [plate, plate], this.colors.rigid);
      let start = 0;
      for (let i = 1; i <= line.length; i++) {
        if (i < line.length && norm(sub(line[i], line[i - 1])) > 1e-6) continue;
        const [points, radii] = [line.slice(start, i), radius.slice(start, i)];
        if (points.length > 1) {
          const rigid = points.length === 2;
          this.tube(points, radii, rigid ? this.colors.rigid : this.colors.limb);
        }
        start = i;
      }
    }

    object({ at, radius_m, above_m, below_m }) {
      if (!finite(at)) return;
      const points = [0, 0.25, 0.5, 0.75, 1].map((s) => [at[0], at[1], at[2] + above_m - s * (above_m + below_m)]);
      this.tube(points, points.map(() => radius_m), this.colors.object);
    }

    solid({ region, shape, lines_m }) {
      const color = region ? this.colors.region : this.colors.obstacle;
      if (shape && shape.sphere && !region) {
        const { center_m, radius_m } = shape.sphere;
        this.tube([center_m, add(center_m, [0, 0, 1e-6])], [radius_m, radius_m], color, true);
      } else if (shape && shape.capsule && !region) {
        const { from_m, to_m, radius_m } = shape.capsule;
        const count = 8;
        const points = Array.from({ length: count + 1 }, (_, i) => add(from_m, sub(to_m, from_m), i / count));
        this.tube(points, points.map(() => radius_m), color, true);
      } else if (shape && shape.box) {
        this.box(shape.box, color, region);
      } else {
        for (const line of lines_m) this.line(line, rgb(color), 1, region ? [4, 3] : []);
      }
    }

    // Faces in patches, so that each has a depth of its own.
    box({ center_m, half_axes_m }, color, region) {
      for (let axis = 0; axis < 3; axis++) {
        const [u, v] = [half_axes_m[(axis + 1) % 3], half_axes_m[(axis + 2) % 3]];
        if (region) {
          // Each edge once: dashes over dashes fill their gaps.
          for (const a of [-1, 1]) for (const b of [-1, 1]) {
            const end = (side) => add(add(add(center_m, half_axes_m[axis], side), u, a), v, b);
            this.line([end(-1), end(1)], rgb(color), 1.25, [4, 3]);
          }
          continue;
        }
        for (const side of [-1, 1]) {
          const middle = add(center_m, half_axes_m[axis], side);
          const corner = (a, b) => add(add(middle, u, a), v, b);
          const shade = Math.abs(unit(half_axes_m[axis])[2]) > 0.7 ? mix(color, [255, 255, 255], side > 0 ? 0.3 : 0) : mix(color, [0, 0, 0], axis === 0 ? 0.12 : 0.24);
          const [n, m] = [u, v].map((edge) => Math.max(1, Math.min(8, Math.round(norm(edge) * 2 / (this.extent * 0.06)))));
          for (let i = 0; i < n; i++) for (let j = 0; j < m; j++) {
            const [a, b, c, d] = [-1 + 2 * i / n, -1 + 2 * (i + 1) / n, -1 + 2 * j / m, -1 + 2 * (j + 1) / m];
            const corners = [corner(a, c), corner(b, c), corner(b, d), corner(a, d)].map((p) => this.project(p));
            const depth = corners.reduce((sum, p) => sum + p[2], 0) / 4;
            this.patches.push({ depth, draw: () => {
              const g = this.g;
              g.beginPath();
              corners.forEach(([x, y], k) => (k ? g.lineTo(x, y) : g.moveTo(x, y)));
              g.closePath();
              Object.assign(g, { fillStyle: rgb(shade, 0.8), strokeStyle: rgb(shade, 0.8), lineWidth: 0.6 });
              g.fill();
            } });
          }
        }
      }
    }

    // With a name it is a square, apart from the rings of setpoints.
    target({ at, along, reached, name }) {
      if (!finite(at)) return;
      const [x, y] = this.project(at);
      const g = this.g;
      if (name) {
        Object.assign(g, { strokeStyle: rgb(this.colors.trail), lineWidth: 2 });
        g.strokeRect(x - 7, y - 7, 14, 14);
        Object.assign(g, { font: "12px system-ui, sans-serif", textAlign: "left", textBaseline: "middle", lineWidth: 3, lineJoin: "round", strokeStyle: rgb(this.colors.page, 0.8), fillStyle: rgb(this.colors.ink) });
        const width = g.measureText(name).width;
        const start = x + 11 + width < this.width ? x + 11 : x - 11 - width;
        g.strokeText(name, start, y);
        g.fillText(name, start, y);
        return;
      }
      Object.assign(g, { strokeStyle: rgb(this.colors.ink), lineWidth: reached ? 2 : 1.25 });
      g.beginPath();
      g.arc(x, y, 5, 0, 2 * Math.PI);
      g.moveTo(x - 8, y);
      g.lineTo(x + 8, y);
      g.moveTo(x, y - 8);
      g.lineTo(x, y + 8);
      g.stroke();
      if (finite(along)) this.line([at, add(at, along, this.extent * 0.06)], rgb(this.colors.ink), 1.25, []);
    }

    axes() {
      const g = this.g;
      const origin = [28, this.height - 28];
      const zero = this.project(this.middle);
      ["x", "y", "z"].forEach((name, i) => {
        const end = this.project(add(this.middle, [0, 1, 2].map((k) => (k === i ? this.extent * 0.1 : 0))));
        const [dx, dy] = [(end[0] - zero[0]), (end[1] - zero[1])];
        const long = this.scale * this.extent * 0.1;
        const [ex, ey] = [origin[0] + dx / long * 18, origin[1] + dy / long * 18];
        Object.assign(g, { strokeStyle: rgb(this.colors.soft), fillStyle: rgb(this.colors.soft), lineWidth: 1.25 });
        g.beginPath();
        g.moveTo(...origin);
        g.lineTo(ex, ey);
        g.stroke();
        if (Math.hypot(dx, dy) < long * 0.25) return;
        Object.assign(g, { font: "11px system-ui, sans-serif", textAlign: "center", textBaseline: "middle" });
        g.fillText(name, origin[0] + dx / long * 25, origin[1] + dy / long * 25);
      });
    }
  }
  return View;
})();
