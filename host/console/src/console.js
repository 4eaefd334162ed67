"use strict";
(() => {
  const by_id = (id) => document.getElementById(id);
  // A tenth of a kPa; never -0.0.
  const kpa = (pressure_pa) => (Math.round(pressure_pa * 1e-2) / 10 + 0).toFixed(1);
  // A whole mm; never -0.
  const mm = (length_m) => (Math.round(length_m * 1e3) + 0).toFixed(0);
  const page = document.documentElement.dataset;
  const REPEAT_MS = 50;
  const SPAN_S = 20;
  const DEAD = 0.3;
  let [scene, view, commands, number, socket] = [null, null, false, 0, null];
  const sent_at = new Map();

  const send = (message) => {
    if (!socket || socket.readyState !== WebSocket.OPEN) return;
    number += 1;
    sent_at.set(number, performance.now());
    socket.send(JSON.stringify({ number, ...message }));
  };
  const order = (name, more = {}) => send({ order: name, ...more });

  // One move at a time, repeated while it is held.
  const hold = {
    source: null, jog: null, timer: 0,
    start(source, jog) {
      if (by_id("steps").checked) {
        if (this.source !== source) order("step", jog);
        this.source = source;
        return;
      }
      const is_new = this.source !== source || JSON.stringify(this.jog) !== JSON.stringify(jog);
      [this.source, this.jog] = [source, jog];
      if (is_new) order("jog", jog);
      if (!this.timer) this.timer = setInterval(() => order("jog", this.jog), REPEAT_MS);
    },
    stop(source) {
      if (this.source === null || (source !== undefined && source !== this.source)) return;
      const moved = this.timer !== 0;
      clearInterval(this.timer);
      [this.source, this.jog, this.timer] = [null, null, 0];
      if (moved) order("stop");
    },
  };
  window.addEventListener("blur", () => hold.stop());
  document.addEventListener("visibilitychange", () => { if (document.hidden) hold.stop(); });
  const picked = (id) => Number(by_id(id).value || 0);
  const jog_of = (move, way, speed = picked("speed")) => ({ drive: move.drive, axis: move.axis, with: way, speed, step: picked("step") });

  // Rows of moves: the tip along three axes, and each module.
  const sliders = [];
  function move_row(move, label) {
    const name = document.createElement("span");
    Object.assign(name, { className: "name", textContent: label });
    const button = (text, way) => {
      const element = document.createElement("button");
      Object.assign(element, { type: "button", textContent: text });
      element.setAttribute("aria-label", `${label} ${way ? "more" : "less"}`);
      const source = `${label} ${way}`;
      element.addEventListener("pointerdown", (event) => { element.setPointerCapture(event.pointerId); hold.start(source, jog_of(move, way)); });
      for (const end of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) element.addEventListener(end, () => hold.stop(source));
      element.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" || event.repeat) return;
        event.preventDefault();
        hold.start(source, jog_of(move, way));
      });
      element.addEventListener("keyup", (event) => { if (event.key === "Enter") hold.stop(source); });
      return element;
    };
    const slider = document.createElement("input");
    Object.assign(slider, { type: "range", min: -3, max: 3, step: 0.01, value: 0 });
    slider.setAttribute("aria-label", `move ${label}`);
    const source = `slider ${label}`;
    const deflected = () => {
      const value = Number(slider.value);
      if (Math.abs(value) < DEAD) { hold.stop(source); return; }
      hold.start(source, jog_of(move, value > 0, Math.min(scene.speeds.length - 1, Math.floor(Math.abs(value)))));
    };
    const back = () => { slider.value = 0; hold.stop(source); };
    slider.addEventListener("input", deflected);
    for (const end of ["pointerup", "pointercancel", "lostpointercapture", "blur", "change"]) slider.addEventListener(end, back);
    slider.addEventListener("keydown", (event) => {
      const way = { ArrowRight: true, ArrowUp: true, ArrowLeft: false, ArrowDown: false }[event.key];
      if (way === undefined) return;
      event.preventDefault();
      if (event.repeat) return;
      slider.value = way ? 1.5 : -1.5;
      hold.start(source, jog_of(move, way));
    });
    slider.addEventListener("keyup", (event) => { if (event.key.startsWith("Arrow")) back(); });
    const value = document.createElement("span");
    value.className = "value";
    by_id("moves").append(name, button("−", false), slider, button("+", true), value);
    sliders.push({ slider, value, move });
  }

  const can_move = () => commands && view && view.session === "live" && !view.task;

  // Keys of the page, where no field takes them.
  const KEYS = { w: [0, true], s: [0, false], a: [1, true], d: [1, false], r: [2, true], f: [2, false] };
  const is_field = (element) => ["SELECT", "TEXTAREA"].includes(element.tagName) || (element.tagName === "INPUT" && element.type !== "range");
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Escape" || (event.key === " " && !is_field(event.target))) {
      event.preventDefault();
      if (!event.repeat) order("vent");
      return;
    }
    if (is_field(event.target) || !can_move()) return;
    const key = event.key.toLowerCase();
    if (key === "g" && !event.repeat) order("gripper");
    const move = KEYS[key];
    if (!move || event.repeat) return;
    hold.start(`key ${key}`, jog_of({ drive: null, axis: move[0] }, move[1]));
  });
  document.addEventListener("keyup", (event) => hold.stop(`key ${event.key.toLowerCase()}`));

  // A gamepad: left stick x and y, right stick z, first button the gripper, second one vents.
  let pressed = [];
  function gamepad() {
    const pad = [...navigator.getGamepads()].find((one) => one && one.connected);
    if (!pad) { if (pressed.length) { pressed = []; hold.stop("gamepad"); } return; }
    const now = pad.buttons.map((button) => button.pressed);
    const is_new = (index) => now[index] && !pressed[index];
    if (is_new(1)) order("vent");
    if (is_new(0)) order("gripper");
    pressed = now;
    const ways = [-(pad.axes[1] || 0), -(pad.axes[0] || 0), -(pad.axes[3] || 0)];
    const axis = [0, 1, 2].reduce((best, one) => (Math.abs(ways[one]) > Math.abs(ways[best]) ? one : best), 0);
    const far = Math.abs(ways[axis]);
    if (far < DEAD || !can_move()) hold.stop("gamepad");
    else hold.start("gamepad", jog_of({ drive: null, axis }, ways[axis] > 0, far > 0.9 ? 2 : far > 0.6 ? 1 : 0));
  }

  for (const name of ["arm", "task", "gripper", "vent", "resume", "end"]) by_id(name).addEventListener("click", () => order(name));
  by_id("hold").addEventListener("click", () => order("stop"));
  by_id("take").addEventListener("click", () => send({ take: true }));
  by_id("break").addEventListener("submit", (event) => {
    event.preventDefault();
    const of_channel = scene.faults[by_id("fault").selectedIndex].of_channel;
    order("break", { name: by_id("fault").value, channel: of_channel ? picked("channel") : null });
  });
  by_id("fault").addEventListener("change", () => { by_id("of_channel").hidden = !scene.faults[by_id("fault").selectedIndex].of_channel; });

  // The limb in space.
  const triple = (name) => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  };
  const colors = () => ({ ...Object.fromEntries(["page", "ink", "soft", "limb", "obstacle", "region", "object", "trail"].map((name) => [name, triple(name)])), rigid: [125, 133, 143] });
  const space = new LimbView(by_id("space"), colors());
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const trail = [];
  const later = { asked: false };
  const draw_soon = () => {
    if (later.asked) return;
    later.asked = true;
    requestAnimationFrame(() => { later.asked = false; draw(); });
  };
  dark.addEventListener("change", () => { space.colors = colors(); draw_soon(); });
  space.onChange = draw_soon;
  for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => space.look(...button.dataset.view.split(",").map(Number)));
  by_id("nearer").addEventListener("click", () => space.scaled(1.25));
  by_id("farther").addEventListener("click", () => space.scaled(0.8));
  by_id("space").addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (!turn || !event.shiftKey) return;
    event.preventDefault();
    space.turn(...turn);
  });

  function draw() {
    if (!scene) return;
    const line = (view && view.line_m) || scene.line_m;
    const radius = (view && view.radius_m) || scene.radius_m;
    const tip = view && (view.tip_m || line[line.length - 1]);
    const carried = view && view.carried && tip ? [{ at: tip, ...view.carried }] : [];
    const next = view && view.next ? [{ at: view.next.at_m, name: view.next.name }] : [];
    const targets = [...next, ...(view && view.setpoint_m ? [{ at: view.setpoint_m }] : [])];
    space.draw({ solids: scene.solids, carried, body: { line, radius }, trail: trail.map((one) => one.tip), targets });
    strips();
  }

  // Pressures of each module over time.
  const rows = [];
  const charts = [];
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const LINES = { light: ["#0072B2", "#CD4318", "#164F43", "#78176D"], dark: ["#56B4E9", "#F7C359", "#C2FEF3", "#E73893"] };
  function strip_of(drive) {
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    const canvas = document.createElement("canvas");
    canvas.setAttribute("aria-label", `pressures of ${drive.name}`);
    const name = document.createElement("b");
    name.textContent = drive.name;
    caption.append(name);
    const labels = drive.channels.map((channel) => {
      const label = document.createElement("span");
      label.dataset.channel = channel;
      caption.append(label);
      return label;
    });
    figure.append(caption, canvas);
    by_id("strips").append(figure);
    charts.push({ canvas, drive, labels });
  }
  const valve = (duty) => (duty > 0 ? "▲" : duty < 0 ? "▼" : "·");
  function strips() {
    const [soft, lines] = [css("soft"), LINES[dark.matches ? "dark" : "light"]];
    const ratio = window.devicePixelRatio || 1;
    const last = rows[rows.length - 1];
    for (const { canvas, drive, labels } of charts) {
      const [width, height] = [canvas.clientWidth, canvas.clientHeight];
      const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
      if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
      const g = canvas.getContext("2d");
      g.setTransform(ratio, 0, 0, ratio, 0, 0);
      g.clearRect(0, 0, width, height);
      const top = drive.pressure_max_pa;
      const y = (pascal) => height - 6 - (height - 14) * Math.max(0, pascal) / top;
      const x = (row) => width - 4 - (width - 44) * (last.time - row.time) / SPAN_S;
      Object.assign(g, { strokeStyle: css("rule"), fillStyle: soft, lineWidth: 1, font: "11px system-ui, sans-serif", textAlign: "right", textBaseline: "middle" });
      for (const level of [0, top / 2, top]) {
        g.beginPath();
        g.moveTo(40, y(level));
        g.lineTo(width - 4, y(level));
        g.stroke();
        g.fillText((level * 1e-3).toFixed(level && top < 2e4 ? 1 : 0), 35, y(level));
      }
      drive.channels.forEach((channel, place) => {
        const color = lines[place % lines.length];
        for (const [part, line_width, alpha] of [[1, 4, 0.3], [0, 1.75, 1]]) {
          g.beginPath();
          rows.forEach((row, index) => { if (row.channels[channel]) g[index ? "lineTo" : "moveTo"](x(row), y(row.channels[channel][part])); });
          Object.assign(g, { strokeStyle: color, lineWidth: line_width, globalAlpha: alpha, lineJoin: "round" });
          g.stroke();
          g.globalAlpha = 1;
        }
        const now = view && view.channels && view.channels[channel];
        const mark = faulted(channel) ? " (fault)" : "";
        labels[place].textContent = (now ? `${channel}: ${kpa(now[0])} of ${kpa(now[1])} ${valve(now[2])}` : `${channel}: –`) + mark;
        labels[place].style.color = color;
      });
    }
  }

  // Whether the device has named the channel in a fault.
  const faulted = (channel) => ((view && view.faults) || []).some((fault) => fault.channel === channel);
  const shown = (element, text) => { element.textContent = text; element.hidden = !text; };
  function show() {
    const live = view && view.session === "live";
    const vented = view && view.session === "vented";
    const free = document.documentElement.dataset.free === "true";
    Object.assign(page, { session: view ? view.session : "none", commands, moving: !!(view && view.moving) });
    by_id("state").textContent = view ? (view.device && (live || vented) ? view.device : view.session) : "no connection";
    by_id("clock").textContent = view && view.time_s !== null ? `${view.time_s.toFixed(1)} s` : "";
    const valves = view && view.valve_supply_v !== null ? `, valves ${view.valve_supply_v.toFixed(1)} V` : "";
    by_id("supply").textContent = view && view.supply_pa !== null ? `supply ${kpa(view.supply_pa)} kPa${valves}` : "";
    by_id("clearance").textContent = view && view.nearest ? `${mm(view.nearest[0])} mm from ${view.nearest[1]}` : "";
    by_id("role").textContent = commands ? "this page commands" : free ? "no page commands" : "this page looks: another one commands";
    by_id("take").hidden = commands || !free;
    shown(by_id("message"), (view && view.message) || "");
    shown(by_id("after"), (view && view.after) || "");
    for (const [id, is_there] of Object.entries({ key_next: view && view.next, key_region: scene && scene.solids.some((solid) => solid.region), key_obstacle: scene && scene.solids.some((solid) => !solid.region) })) by_id(id).hidden = !is_there;
    const refusal = (view && view.refusal) || refused;
    shown(by_id("refusal"), refusal ? `Refused: ${refusal}` : "");
    const task = view && view.task;
    const able = { arm: view && view.session === "idle", task: live && scene.task && (!task || task.is_held), hold: live, gripper: live && !task, resume: vented && view.device === "ready", end: live || vented };
    for (const [id, is_able] of Object.entries(able)) by_id(id).disabled = !(commands && is_able);
    by_id("task").textContent = task && task.is_held ? "Go on with the task" : "Run the task";
    by_id("gripper").textContent = view && view.gripping ? "Open the gripper" : "Close the gripper";
    by_id("report").hidden = !(view && view.report);
    by_id("progress").textContent = task ? `Task: phase ${task.phase}, ${task.time_s.toFixed(1)} of ${task.duration_s.toFixed(1)} s${task.is_held ? ", held" : ""}` : scene && scene.task_refused ? `No task: ${scene.task_refused}` : "";
    by_id("target").textContent = live && view.target ? view.target : "";
    const tip = view && view.tip_m;
    by_id("tip").textContent = tip ? `tip x ${mm(tip[0])}  y ${mm(tip[1])}  z ${mm(tip[2])} mm` : "";
    for (const { slider, value, move } of sliders) {
      slider.disabled = !can_move();
      const [drive, place] = [move.drive, move.axis];
      if (drive === null) value.textContent = tip ? `${mm(tip[place])} mm` : "";
      else {
        const first = scene.drives[drive].channels[0];
        const now = view && view.channels && view.channels[first];
        value.textContent = now ? `${kpa(now[1])} kPa` : "";
      }
    }
    for (const button of by_id("moves").querySelectorAll("button")) button.disabled = !can_move();
    const faults = ((view && view.faults) || []).map((fault) => fault.text);
    const list = by_id("faults");
    // A session may stop without a fault of the device: its cause is the message.
    const texts = faults.length ? faults : [view && view.message ? "none reported by the device" : "none"];
    if (list.dataset.texts !== texts.join("\n")) {
      list.dataset.texts = texts.join("\n");
      list.replaceChildren(...texts.map((text) => Object.assign(document.createElement("li"), { textContent: text, className: faults.length ? "" : "soft" })));
    }
    by_id("break").hidden = !(scene && scene.simulated);
    by_id("break").querySelector("button").disabled = !(commands && live);
  }

  let refused = "";
  let refused_timer = 0;
  function begin(told) {
    scene = told;
    by_id("name").textContent = `${scene.name} on ${scene.port}${scene.weightless ? ", weightless" : ""}`;
    document.title = `${scene.name}, softlimb console`;
    by_id("moves").replaceChildren();
    by_id("strips").replaceChildren();
    for (const list of [sliders, charts, rows, trail]) list.length = 0;
    ["x", "y", "z"].forEach((axis, index) => move_row({ drive: null, axis: index }, `tip ${axis}`));
    scene.drives.forEach((drive, index) => { move_row({ drive: index, axis: 0 }, drive.name); strip_of(drive); });
    const options = (id, texts, chosen) => by_id(id).replaceChildren(...texts.map((text, index) => Object.assign(document.createElement("option"), { value: index, textContent: text, selected: index === chosen })));
    options("speed", scene.speeds.map((one) => `${one} mm, deg or kPa a second`), 1);
    options("step", scene.steps.map((one) => `${one} mm, deg or kPa`), 1);
    by_id("fault").replaceChildren(...scene.faults.map(({ name }) => Object.assign(document.createElement("option"), { value: name, textContent: name })));
    by_id("of_channel").hidden = !(scene.faults[0] && scene.faults[0].of_channel);
    options("channel", Array.from({ length: scene.channels }, (_, index) => String(index)), 0);
    const reach = scene.reach_m;
    const base = scene.line_m[0];
    const corners = [-1, 1].flatMap((side) => [0, 1, 2].map((axis) => base.map((part, index) => part + (index === axis ? 0.45 * side * reach : 0))));
    space.fit([...scene.line_m, ...corners, ...scene.solids.flatMap((solid) => solid.lines_m.flat())]);
  }

  function take_view(message) {
    ({ view, commands } = message);
    page.free = String(message.free);
    if (view && view.channels) {
      if (rows.length && view.time_s < rows[rows.length - 1].time) rows.length = 0;
      rows.push({ time: view.time_s, channels: view.channels });
      while (view.time_s - rows[0].time > SPAN_S) rows.shift();
    }
    if (view && view.tip_m) {
      const last = trail[trail.length - 1];
      if (!last || view.time_s >= last.time) trail.push({ time: view.time_s, tip: view.tip_m });
      else trail.length = 0;
      while (trail.length && view.time_s - trail[0].time > SPAN_S) trail.shift();
    }
    show();
    draw_soon();
    page.updates = Number(page.updates || 0) + 1;
  }

  function connect() {
    socket = new WebSocket(new URL("socket", location.href.replace(/^http/, "ws")));
    socket.addEventListener("message", ({ data }) => {
      const message = JSON.parse(data);
      if (message.scene) { begin(message.scene); show(); draw_soon(); page.ready = "yes"; }
      else if (message.taken) {
        page.delay = (performance.now() - (sent_at.get(message.taken) ?? NaN)).toFixed(2);
        for (const key of sent_at.keys()) if (key <= message.taken) sent_at.delete(key);
        page.taken = message.taken;
      } else if (message.refused) {
        refused = message.refused;
        clearTimeout(refused_timer);
        refused_timer = setTimeout(() => { refused = ""; show(); }, 4000);
        show();
      } else take_view(message);
    });
    socket.addEventListener("close", () => {
      [view, commands] = [null, false];
      hold.stop();
      show();
      setTimeout(connect, 1000);
    });
  }
  const frame = () => { gamepad(); requestAnimationFrame(frame); };
  requestAnimationFrame(frame);
  connect();
})();
