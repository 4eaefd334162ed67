"use strict";
(async () => {
  const by_id = (id) => document.getElementById(id);
  const run = JSON.parse(by_id("run").textContent);
  const tables = await Columns.tables("numbers", run.tables);
  const { samples, bodies, lines } = tables;
  const count = samples.rows;
  if (!count) { document.documentElement.dataset.ready = "nothing"; return; }

  const themes = {
    light: {
      lines: ["#0072B2", "#CD4318", "#164F43", "#78176D"], page: "#FFFFFF", ink: "#1B1F24", soft: "#57606A", grid: "#D9DEE5", band: "#F1F3F6", mark: "#B3261E",
      space: { page: [255, 255, 255], ink: [27, 31, 36], soft: [87, 96, 106], limb: [86, 156, 200], rigid: [120, 128, 138], obstacle: [205, 135, 105], region: [22, 79, 67], object: [150, 95, 150], trail: [205, 67, 24] },
    },
    dark: {
      lines: ["#56B4E9", "#F7C359", "#C2FEF3", "#E73893"], page: "#14171B", ink: "#E6E9EE", soft: "#9AA4AF", grid: "#333A44", band: "#1E2329", mark: "#FF8A80",
      space: { page: [20, 23, 27], ink: [230, 233, 238], soft: [154, 164, 175], limb: [70, 140, 190], rigid: [130, 138, 148], obstacle: [190, 120, 90], region: [194, 254, 243], object: [190, 120, 190], trail: [247, 195, 89] },
    },
  };
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const theme = () => (dark.matches ? themes.dark : themes.light);

  // Points of a table at a row, and between two rows.
  const columns = (table, name) => ["x", "y", "z"].map((axis) => table[`${name}_${axis}`]);
  const at = (column, row, share) => (share ? column[row] + (column[row + 1] - column[row]) * share : column[row]);
  const point = (three, row, share = 0) => three.map((column) => at(column, row, share));
  const places = (table, name, points) => Array.from({ length: points }, (_, index) => columns(table, `${name}_${index}`));
  function between(times, time) {
    const row = Columns.row_at(times, time);
    const long = row + 1 < times.length ? times[row + 1] - times[row] : 0;
    return [row, long > 0 ? Math.max(0, Math.min(1, (time - times[row]) / long)) : 0];
  }

  const { space } = run;
  const [tip, tip_set] = [columns(samples, "tip"), columns(samples, "tip_set")];
  const body_points = places(bodies, "body", space.body_points);
  const radii = Array.from({ length: space.body_points }, (_, index) => bodies[`radius_${index}`]);
  const [set_points, seen_points] = [places(lines, "set", space.line_points[0]), places(lines, "seen", space.line_points[1])];
  const line_at = (points, row, share) => (lines.rows && points.length ? points.map((three) => point(three, row, share)) : null);
  const is_seen = tip[0].some(Number.isFinite);
  const path_of = (three) => {
    const every = Math.max(1, Math.ceil(count / 500));
    return Array.from({ length: Math.ceil(count / every) }, (_, index) => [samples.t[index * every], point(three, index * every)]);
  };
  const [trail, planned] = [path_of(is_seen ? tip : tip_set), path_of(tip_set).map(([, place]) => place)];
  const start_line = line_at(set_points, 0, 0);
  const targets = run.phases.map((phase) => {
    const row = Columns.row_at(samples.t, phase.end);
    const line = line_at(set_points, ...(lines.rows ? between(lines.t, phase.end) : [0, 0]));
    const along = line && line.length > 1 ? line[line.length - 1].map((end, axis) => end - line[line.length - 2][axis]) : null;
    const long = along ? Math.hypot(...along) || 1 : 1;
    return { time: phase.end, at: point(tip_set, row), along: along && along.map((part) => part / long) };
  });

  // An object stands where the plan takes it before, and where it is put behind.
  function objects(time) {
    const shown = new Map();
    for (const object of space.carried) {
      const { name, from_s, to_s } = object;
      const before = shown.get(name);
      if (before && time < from_s) continue;
      const held = Math.max(from_s, Math.min(time, to_s ?? Infinity));
      const lost = run.marks.find((mark) => mark.lost && mark.time >= from_s && mark.time <= held);
      const stands = time < from_s && object.start_m;
      const place = stands ? object.start_m : point(is_seen ? tip : tip_set, Columns.row_at(samples.t, held));
      shown.set(name, { ...object, at: lost ? [NaN, NaN, NaN] : place });
    }
    return [...shown.values()];
  }

  const canvas = by_id("space");
  const view = new LimbView(canvas, theme().space);
  const [names, low] = [run.states, (value) => Number.isFinite(value)];
  // Plates reach farther than the tubes.
  const around = (row) => body_points.flatMap((three, index) => {
    const [place, reach] = [point(three, row), 1.5 * radii[index][row]];
    return [place.map((value) => value - reach), place.map((value) => value + reach)];
  });
  view.fit([
    ...start_line || [], ...trail.map(([, place]) => place), ...planned,
    ...space.solids.flatMap((solid) => solid.lines_m.flat()),
    ...Array.from({ length: 20 }, (_, index) => Math.floor(index * bodies.rows / 20)).flatMap(around),
  ].filter((place) => place.every(low)));

  const states = [];
  for (let row = 0; row < count; row++) {
    const state = samples.state[row];
    const last = states[states.length - 1];
    if (last && last.state === state) last.end = samples.t[row]; else states.push({ state, name: names[state] || "unknown", start: samples.t[row], end: samples.t[row] });
  }
  states.forEach((state, index) => { if (states[index + 1]) state.end = states[index + 1].start; });
  const ending = states.filter(({ name, start, end }) => ["venting", "faulted"].includes(name) && end > start);

  const section_of = (name) => {
    const first = by_id("first");
    if (["Error of the tip", "Clearance"].includes(name)) return first;
    const id = `section-${name.toLowerCase().replace(/\W+/g, "-")}`;
    if (!by_id(id)) {
      const heading = document.createElement("h2");
      heading.textContent = name;
      const grid = document.createElement("div");
      Object.assign(grid, { id, className: "panels" });
      by_id("panels").append(heading, grid);
    }
    return by_id(id);
  };

  // The track of time: phases, states that end a run, faults.
  const [first_s, last_s] = [samples.t[0], samples.t[count - 1]];
  const share = (time) => `${(100 * Math.max(0, Math.min(1, (time - first_s) / Math.max(last_s - first_s, 1e-9)))).toFixed(3)}%`;
  const track = by_id("track");
  const segment = ({ start, end, name }, kind) => {
    const element = document.createElement("button");
    Object.assign(element, { type: "button", className: `segment ${kind}`, title: `${name}: ${start.toFixed(2)} to ${end.toFixed(2)} s`, tabIndex: -1 });
    element.style.left = share(start);
    element.style.width = `calc(${share(end)} - ${share(start)})`;
    const label = document.createElement("span");
    label.textContent = name;
    element.append(label);
    element.addEventListener("click", () => go(end - 1e-6));
    track.append(element);
  };
  run.phases.forEach((phase, index) => segment(phase, index % 2 ? "phase" : "phase shaded"));
  ending.forEach((state) => segment(state, state.name === "faulted" ? "state alarming" : "state"));
  for (const mark of run.marks) {
    const element = document.createElement("button");
    Object.assign(element, { type: "button", className: "fault", title: mark.text });
    element.setAttribute("aria-label", mark.text);
    element.style.left = share(mark.time);
    element.addEventListener("click", () => go(mark.time));
    track.append(element);
  }
  // A name without room is left out; its band has it as a title.
  const fitted = () => {
    for (const label of track.querySelectorAll("span")) label.hidden = false;
    const narrow = [...track.querySelectorAll("span")].filter((label) => label.scrollWidth > label.parentNode.clientWidth - 4);
    narrow.forEach((label) => { label.hidden = true; });
  };

  const [slider, play, speed] = [by_id("slider"), by_id("play"), by_id("speed")];
  slider.max = count - 1;
  let [row, waiting, plots] = [0, false, null];
  const errors = samples.error, distances = bodies.clearance;
  function phase_at(time) {
    const state = ending.find(({ start, end }) => time >= start && time <= end);
    const phase = run.phases.find(({ start, end }) => time >= start - 1e-6 && time < end);
    return [phase && phase.name, state && state.name].filter(Boolean).join(", ") || names[samples.state[row]] || "";
  }
  const mm = (name, value) => (Number.isFinite(value) ? `${name} ${value.toFixed(1)} mm` : "");

  // Shows a row of the samples.
  function show() {
    const time = samples.t[row];
    const [body_row, body_share] = bodies.rows ? between(bodies.t, time) : [0, 0];
    const [line_row, line_share] = lines.rows ? between(lines.t, time) : [0, 0];
    const body = space.body_points && bodies.rows ? { line: body_points.map((three) => point(three, body_row, body_share)), radius: radii.map((radius) => at(radius, body_row, body_share)) } : null;
    const gone = trail.filter(([when]) => when <= time).map(([, place]) => place);
    gone.push(point(is_seen ? tip : tip_set, row));
    const seen_line = line_at(seen_points, line_row, line_share);
    view.draw({
      solids: space.solids, carried: objects(time), body, seen: seen_line, ghost: line_at(set_points, line_row, line_share),
      start: start_line, plan: planned, trail: gone, targets: targets.map((target) => ({ ...target, reached: time >= target.time - 1e-6 })),
    });
    const values = [errors && mm("tip error", errors[row]), distances && bodies.rows ? mm("clearance", distances[body_row]) : ""].filter(Boolean).join(" · ");
    by_id("now").textContent = `${time.toFixed(2)} s`;
    by_id("phase").textContent = phase_at(time);
    by_id("values").textContent = values;
    slider.value = row;
    slider.setAttribute("aria-valuetext", `${time.toFixed(2)} s, ${phase_at(time)}${values ? `, ${values}` : ""}`);
    if (plots) plots.show(time);
    canvas.dataset.row = row;
  }
  function later() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; show(); });
  }
  function to_row(next) {
    row = Math.max(0, Math.min(count - 1, next));
    later();
  }
  function go(time) { to_row(Columns.row_at(samples.t, time)); }

  let playing = null;
  function toggle() {
    if (playing) { playing = null; } else {
      if (row === count - 1) row = 0;
      playing = { from: samples.t[row], since: performance.now() };
      requestAnimationFrame(step);
    }
    play.textContent = playing ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(!!playing));
  }
  function step(now) {
    if (!playing) return;
    const time = playing.from + Math.max(0, now - playing.since) / 1e3 * Number(speed.value);
    row = Columns.row_at(samples.t, time);
    show();
    if (row >= count - 1) toggle(); else requestAnimationFrame(step);
  }
  // From here on at this speed.
  function restart() { if (playing) playing = { from: samples.t[row], since: performance.now() }; }

  slider.addEventListener("input", () => { to_row(Number(slider.value)); restart(); });
  play.addEventListener("click", toggle);
  speed.addEventListener("change", restart);
  view.onChange = later;
  const looks = { space: [-1.0, 0.35], front: [0, 0], side: [-Math.PI / 2, 0], top: [-Math.PI / 2, Math.PI / 2] };
  for (const button of document.querySelectorAll("[data-look]")) button.addEventListener("click", () => view.look(...looks[button.dataset.look]));
  canvas.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    const scale = { "+": 1.15, "=": 1.15, "-": 1 / 1.15 }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey || !(turn || scale)) return;
    if (turn) view.turn(...turn); else view.scaled(scale);
    event.preventDefault();
    event.stopPropagation();
  });
  document.addEventListener("keydown", (event) => {
    const { key, target } = event;
    const other = target.closest("select, textarea, pre, a") || (target.closest("button") && (key === " " || key === "Enter"));
    if (other || event.ctrlKey || event.metaKey || event.altKey) return;
    const second = () => Columns.row_at(samples.t, samples.t[row] + 1) - row || 1;
    const stride = event.shiftKey ? second() : 1;
    const [from, to] = plots ? plots.range : [first_s, last_s];
    const zoom = (scale) => { const time = samples.t[row]; plots.zoom([time - (time - from) * scale, time + (to - time) * scale]); };
    const actions = {
      ArrowLeft: () => to_row(row - stride), ArrowRight: () => to_row(row + stride), Home: () => to_row(0), End: () => to_row(count - 1),
      " ": toggle, "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2), 0: () => plots.zoom(null),
    };
    if (!actions[key]) return;
    event.preventDefault();
    actions[key]();
    restart();
  });
  by_id("whole").addEventListener("click", () => plots.zoom(null));

  const paint = (chosen, fixed) => {
    Object.assign(view, { colors: chosen.space, bounds: null });
    if (plots) plots.paint(chosen, fixed);
    show();
  };
  dark.addEventListener("change", () => paint(theme()));
  addEventListener("beforeprint", () => { document.body.classList.add("paper"); paint(themes.light, 340); });
  addEventListener("afterprint", () => { document.body.classList.remove("paper"); paint(theme()); });
  addEventListener("resize", fitted);

  document.body.classList.add("moving");
  fitted();
  // The page opens at the end of the phase with the largest error, or at the first fault.
  if (count) row = Columns.row_at(samples.t, run.opens);
  show();
  // The limb is there before the plots: their script takes a while to unpack.
  const script = document.createElement("script");
  script.textContent = new TextDecoder().decode(await Columns.inflated("plotly"));
  document.head.append(script);
  plots = new Plots(run, tables, ending, theme(), section_of);
  plots.onTime = (time) => { go(time); restart(); };
  plots.show(samples.t[row]);
  // Shows a row at once.
  window.report = { rows: count, show: (next) => { row = next; show(); }, plots, view };
  document.documentElement.dataset.ready = "plots";
})();
