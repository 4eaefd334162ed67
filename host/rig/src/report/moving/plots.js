"use strict";
// Panels of lines over one time axis. All of them show the same interval and the same cursor.
const Plots = (() => {
  const INTERVALS = 1200;
  const MARGIN = { l: 54, r: 112, t: 6, b: 24 };
  const LETTER_PX = 6.5;
  const LABEL_PX = 15;
  const TICK_PX = 40;

  const made = (tag, name, parent) => {
    const element = document.createElement(tag);
    element.className = name;
    parent.append(element);
    return element;
  };
  const number = (value, digits) => (Number.isFinite(value) ? value.toFixed(digits) : "–");
  const faded = (color, alpha) => color + Math.round(alpha * 255).toString(16).padStart(2, "0");
  // Labels of shapes take tags.
  const escaped = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");

  class Panel {
    constructor(described, parent, all) {
      Object.assign(this, { described, all, shown: false, drawn: false });
      this.box = made("section", "panel", parent);
      made("h3", "", this.box).textContent = described.title;
      const axis = made("p", "axis", this.box);
      made("span", "", axis).textContent = described.axis;
      made("span", "", axis).textContent = "at the cursor";
      this.frame = made("div", "frame", this.box);
      this.plot = made("div", "plot", this.frame);
      this.cursor = made("div", "cursor", this.frame);
      const named = described.traces.filter((trace) => trace.style !== "setpoint" || described.traces.length <= 3);
      this.labels = named.map((trace) => {
        const label = made("div", "label", this.frame);
        const sample = made("i", trace.style, label);
        if (trace.width) sample.style.height = `${trace.width + 1}px`;
        made("span", "", label).textContent = trace.name;
        return { trace, label, value: made("b", "", label), text: "" };
      });
    }

    color(trace) { return this.all.theme.lines[trace.color]; }

    values(trace) { return this.all.tables[trace.table][trace.column]; }

    times(trace) { return this.all.tables[trace.table].t; }

    data() {
      const [from, to] = this.all.range;
      return this.described.traces.map((trace) => {
        const { x, y } = Columns.thinned(this.times(trace), this.values(trace), from, to, INTERVALS);
        const color = this.color(trace);
        const line = { line: { color, width: 2 }, setpoint: { color: faded(color, 0.7), width: 6 }, planned: { color, width: 1.5, dash: "dash" }, required: { color, width: 2, dash: "dot" } };
        const alone = x.length < 2 ? "markers" : "lines";
        return { type: "scatter", mode: alone, marker: { color }, x, y, name: trace.name, line: { ...line[trace.style], ...(trace.width && { width: trace.width }) }, hovertemplate: `%{y:.${this.digits()}f}` };
      });
    }

    // Digits behind the point that a value needs, by the height of the panel.
    digits() {
      const [low, high] = this.span || [0, 1];
      return Math.max(0, Math.min(4, 2 - Math.floor(Math.log10(Math.max(high - low, 1e-9)))));
    }

    // The interval of the values that are seen.
    seen() {
      const [from, to] = this.all.range;
      let [low, high] = [Infinity, -Infinity];
      for (const trace of this.described.traces) {
        const [times, values] = [this.times(trace), this.values(trace)];
        if (!times.length) continue;
        const last = Columns.row_at(times, to);
        for (let row = Columns.row_at(times, from); row <= last; row++) {
          if (values[row] < low) low = values[row];
          if (values[row] > high) high = values[row];
        }
      }
      if (!(low <= high)) return [0, 1];
      if (this.described.most) high = Math.min(high, Math.max(low, this.described.most));
      if (this.described.from_zero) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
      const room = Math.max(high - low, 1e-3 * Math.abs(high), 1e-4) * 0.07;
      // Names of phases have room above the lines.
      return [this.described.from_zero && low === 0 ? 0 : low - room, high + 2.5 * room];
    }

    layout() {
      const { theme, range, width } = this.all;
      const axis = {
        color: theme.soft, gridcolor: theme.grid, linecolor: theme.grid, zeroline: false, gridwidth: 0.75,
        tickfont: { size: 12, color: theme.soft },
      };
      // Labels of times turn, and are cut off, where they have no room beside each other.
      const times = Math.max(2, Math.min(7, Math.floor((width(this.frame) - MARGIN.l - MARGIN.r) / TICK_PX)));
      return {
        width: width(this.frame), height: this.described.traces.length > 3 ? 230 : 200, margin: MARGIN,
        paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
        font: { family: 'system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif', size: 12, color: theme.ink },
        showlegend: false, hovermode: "x unified", hoverdistance: 30, dragmode: "zoom",
        hoverlabel: { bgcolor: theme.page, bordercolor: theme.grid, font: { size: 12, color: theme.ink } },
        xaxis: { ...axis, range: [...range], nticks: times, tickangle: 0, ticksuffix: " s", hoverformat: ".2f", showspikes: true, spikemode: "across", spikethickness: 1, spikedash: "dot", spikecolor: theme.soft },
        yaxis: { ...axis, range: [...this.span], fixedrange: true, automargin: false, nticks: 6 },
        shapes: this.shapes(),
      };
    }

    // Phases and states of the device as bands, faults as lines; a band has its name where there is room.
    shapes() {
      const { theme, range, width, run } = this.all;
      const room = width(this.frame) - MARGIN.l - MARGIN.r;
      const px = room / Math.max(range[1] - range[0], 1e-9);
      const band = ({ start, end, name }, style) => {
        const fits = (Math.min(end, range[1]) - Math.max(start, range[0])) * px > name.length * LETTER_PX + 8;
        const label = { text: escaped(name), textposition: "top center", font: { size: 11, color: theme.soft }, padding: 2 };
        const [x0, x1] = [Math.max(start, range[0]), Math.min(end, range[1])];
        const rect = { type: "rect", yref: "paper", x0, x1, y0: 0, y1: 1, line: { width: 0 } };
        // The name is above the grid, which would cross its letters.
        const named = { ...rect, layer: "above", fillcolor: "rgba(0,0,0,0)", label };
        return fits ? [{ ...rect, layer: "below", ...style }, named] : [{ ...rect, layer: "below", ...style }];
      };
      const visible = ({ start, end }) => end > range[0] && start < range[1];
      const phases = run.phases.map((phase, index) => [phase, { fillcolor: index % 2 ? "rgba(0,0,0,0)" : theme.band }]);
      const states = this.all.states.map((state) => [state, { fillcolor: faded(state.name === "faulted" ? theme.mark : theme.soft, 0.18) }]);
      const bands = [...phases, ...states].filter(([one]) => visible(one)).flatMap(([one, style]) => band(one, style));
      const marks = run.marks.filter((mark) => mark.time >= range[0] && mark.time <= range[1]);
      const line = (mark) => ({ type: "line", yref: "paper", x0: mark.time, x1: mark.time, y0: 0, y1: 1, line: { color: theme.mark, width: 1.5 } });
      return [...bands, ...marks.map(line)];
    }

    draw() {
      this.span = this.seen();
      const first = !this.drawn;
      this.drawn = true;
      const config = { displayModeBar: false, doubleClick: false, showTips: false };
      Plotly.react(this.plot, this.data(), this.layout(), config);
      if (first) this.listen();
      this.place();
      this.show();
    }

    listen() {
      this.plot.on("plotly_relayout", (change) => {
        const [from, to] = [change["xaxis.range[0]"], change["xaxis.range[1]"]];
        if (from !== undefined && to !== undefined) this.all.zoom([Number(from), Number(to)]);
      });
      this.plot.on("plotly_doubleclick", () => this.all.zoom(null));
      this.plot.on("plotly_click", (event) => this.all.onTime(event.points[0].x));
    }

    // Labels at the ends of the lines, apart from each other.
    place() {
      const { yaxis, _size: size } = this.plot._fullLayout;
      const level = ({ trace }) => {
        const [times, values] = [this.times(trace), this.values(trace)];
        for (let row = Columns.row_at(times, this.all.range[1]); row >= 0 && times[row] >= this.all.range[0]; row--) {
          // A line may leave its plot at the top.
          if (Number.isFinite(values[row])) return Math.max(LABEL_PX / 2, yaxis.d2p(values[row]));
        }
        return size.h / 2;
      };
      const sorted = this.labels.map((one) => ({ ...one, y: level(one) })).sort((a, b) => a.y - b.y);
      sorted.forEach((one, index) => { if (index) one.y = Math.max(one.y, sorted[index - 1].y + LABEL_PX); });
      let bottom = size.h;
      for (const one of sorted.reverse()) {
        one.y = Math.min(one.y, bottom);
        bottom = one.y - LABEL_PX;
        one.label.style.transform = `translateY(${(size.t + one.y - LABEL_PX / 2).toFixed(1)}px)`;
        one.label.firstChild.style.color = this.color(one.trace);
      }
      Object.assign(this.cursor.style, { top: `${size.t}px`, height: `${size.h}px` });
    }

    // Cursor and values at the time of the page.
    show() {
      if (!this.drawn) return;
      const { xaxis, _size: size } = this.plot._fullLayout;
      const { time, range } = this.all;
      this.cursor.hidden = time < range[0] || time > range[1];
      this.cursor.style.transform = `translateX(${(size.l + xaxis.d2p(time)).toFixed(1)}px)`;
      const digits = Math.min(3, this.digits() + 1);
      for (const one of this.labels) {
        const times = this.times(one.trace);
        const text = number(times.length ? this.values(one.trace)[Columns.row_at(times, time)] : NaN, digits);
        if (text !== one.text) one.value.textContent = one.text = text;
      }
    }
  }

  class All {
    // `run` describes the panels over tables; `places` maps a section to its element.
    constructor(run, tables, states, theme, place) {
      const { t } = tables.samples;
      Object.assign(this, { run, tables, states, theme, time: t[0], whole: [t[0], Math.max(t[t.length - 1], t[0] + 0.1)] });
      this.range = this.whole;
      this.width = (frame) => this.fixed || Math.max(280, Math.floor(frame.clientWidth));
      this.panels = run.panels.map((panel) => new Panel(panel, place(panel.section), this));
      this.onTime = () => {};
      const near = new IntersectionObserver((entries) => {
        for (const entry of entries) {
          const panel = this.panels.find(({ frame }) => frame === entry.target);
          panel.shown = entry.isIntersecting;
          if (panel.shown) this.refresh(panel);
        }
      }, { rootMargin: "200px" });
      const sized = new ResizeObserver((entries) => {
        for (const { target } of entries) {
          const panel = this.panels.find(({ frame }) => frame === target);
          if (panel.drawn && !this.fixed && panel.plot._fullLayout.width !== this.width(target)) this.renew(panel);
        }
      });
      for (const { frame } of this.panels) { near.observe(frame); sized.observe(frame); }
    }

    // Draws a panel that is behind, or moves its cursor.
    refresh(panel) {
      if (!panel.drawn || panel.stale) { panel.stale = false; panel.draw(); } else panel.show();
    }

    renew(panel) {
      panel.stale = true;
      if (panel.shown) this.refresh(panel);
    }

    zoom(range) {
      const [low, high] = this.whole;
      let [from, to] = range || this.whole;
      if (!(to - from > 0.02)) to = from + 0.02;
      this.range = [Math.max(low, Math.min(from, high - 0.02)), Math.min(high, Math.max(to, low + 0.02))];
      document.body.classList.toggle("zoomed", this.range[0] > low || this.range[1] < high);
      for (const panel of this.panels) this.renew(panel);
    }

    show(time) {
      this.time = time;
      for (const panel of this.panels) if (panel.shown) panel.show();
    }

    // Every panel in another theme; of a fixed width for paper.
    paint(theme, fixed) {
      Object.assign(this, { theme, fixed });
      for (const panel of this.panels) {
        if (fixed) { panel.stale = false; panel.draw(); } else this.renew(panel);
      }
    }
  }

  return All;
})();
