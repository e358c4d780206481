// Draws the figures of a page: charts that zoom, surfaces that turn. Plain data come from page_data (runtime/figure);
// nothing is loaded from anywhere.
"use strict";
(() => {
  const dashes = { line: [], dashed: [7, 4], dotted: [1.5, 3], dash_dot: [8, 3, 1.5, 3], line_points: [], points: [] };
  const hasLine = (style) => ["line", "dashed", "dotted", "dash_dot", "line_points"].includes(style);
  const hasPoints = (style) => ["points", "line_points", "stems"].includes(style);
  const finite = Number.isFinite;

  // ---- axes ----

  function niceStep(span, wanted) {
    const raw = span / Math.max(1, wanted), decade = 10 ** Math.floor(Math.log10(raw));
    for (const factor of [1, 2, 5]) if (factor * decade >= raw * (1 - 1e-9)) return factor * decade;
    return 10 * decade;
  }

  const superscript = (n) => String(n).replace(/./g, (c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]));
  const minus = (text) => (/[1-9]/.test(text) ? text.replace("-", "−") : text.replace("-", ""));

  function logTicks(low, high) {
    const ticks = [], decades = Math.log10(high / low), first = Math.floor(Math.log10(low));
    const stride = Math.max(1, Math.floor(decades / 6));
    for (let decade = first; decade <= Math.ceil(Math.log10(high)); ++decade)
      for (const digit of decades < 2 ? [1, 2, 5] : [1]) {
        const value = digit * 10 ** decade;
        if (value < low || value > high || (decade - first) % stride) continue;
        ticks.push([value, decades < 2 ? String(+value.toPrecision(3)) : "10" + superscript(decade)]);
      }
    return ticks.length > 1 ? ticks : [[low, low.toPrecision(3)], [high, high.toPrecision(3)]];
  }

  function ticksOf(axis, low, high, wanted) {
    if (axis.names) return axis.names.map((name, i) => [i + 1, name]).filter(([at]) => at >= low && at <= high);
    if (axis.log) return logTicks(low, high);
    const a = low / axis.factor, b = high / axis.factor, step = niceStep(b - a, wanted), ticks = [];
    const decimals = Math.min(12, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
    for (let i = Math.ceil(a / step - 1e-9); i <= b / step + 1e-9; ++i)
      ticks.push([i * step * axis.factor, minus((i * step).toFixed(decimals))]);
    return ticks;
  }

  // ---- colours ----

  function mixed(palette, place) {
    const at = Math.min(1, Math.max(0, place)) * (palette.length - 1), i = Math.min(palette.length - 2, Math.floor(at));
    const part = (colour, k) => parseInt(colour.slice(1 + 2 * k, 3 + 2 * k), 16), share = at - i;
    return [0, 1, 2].map((k) => Math.round(part(palette[i], k) * (1 - share) + part(palette[i + 1], k) * share));
  }
  const rgb = (c) => `rgb(${c[0]},${c[1]},${c[2]})`;

  function placeOn(axis, value) {
    if (axis.log) return value > 0 ? Math.log(value / axis.min) / Math.log(axis.max / axis.min) : NaN;
    return (value - axis.min) / (axis.max - axis.min);
  }

  // ---- a canvas that fills its box ----

  class Sheet {
    constructor(parent, height) {
      this.canvas = document.createElement("canvas");
      this.canvas.style.cssText = `width:100%;height:${height}px;touch-action:none;display:block`;
      parent.append(this.canvas);
      this.height = height;
      this.pen = this.canvas.getContext("2d");
    }
    clear(figure) {
      const ratio = window.devicePixelRatio || 1;
      this.width = this.canvas.clientWidth || 600;
      this.canvas.width = Math.round(this.width * ratio);
      this.canvas.height = Math.round(this.height * ratio);
      this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.pen.fillStyle = figure.paper;
      this.pen.fillRect(0, 0, this.width, this.height);
      this.pen.font = "12px system-ui, sans-serif";
    }
    text(words, x, y, align, base, colour, turned) {
      const pen = this.pen;
      pen.save();
      pen.translate(x, y);
      if (turned) pen.rotate(-Math.PI / 2);
      pen.textAlign = align;
      pen.textBaseline = base;
      pen.fillStyle = colour;
      pen.fillText(words, 0, 0);
      pen.restore();
    }
  }

  // ---- charts ----

  class Chart {
    constructor(parent, figure, panel) {
      this.figure = figure;
      this.panel = panel;
      const rows = panel.bars ? panel.bars.names.length * (8 + 14 * panel.bars.sets.length) + 60 : 0;
      this.sheet = new Sheet(parent, panel.bars ? Math.max(150, rows) : panel.map ? 340 : 280);
      this.reset();
      this.listen();
    }

    reset() {
      const { x, y } = this.panel;
      this.view = { x: [x.min, x.max], y: [y.min, y.max] };
    }

    // Places within an axis that may be logarithmic, from 0 to 1.
    share(name, value) {
      const [low, high] = this.view[name];
      if (this.panel[name].log) return value > 0 ? Math.log(value / low) / Math.log(high / low) : NaN;
      return (value - low) / (high - low);
    }
    value(name, share) {
      const [low, high] = this.view[name];
      return this.panel[name].log ? low * (high / low) ** share : low + share * (high - low);
    }
    at(x, y) {
      const b = this.box;
      return [b.left + this.share("x", x) * b.width, b.bottom - this.share("y", y) * b.height];
    }

    draw() {
      const { sheet, figure, panel } = this, pen = sheet.pen;
      sheet.clear(figure);
      const wide = sheet.width;
      this.xTicks = ticksOf(panel.x, ...this.view.x, wide / 90);
      this.yTicks = panel.bars ? [] : ticksOf(panel.y, ...this.view.y, sheet.height / 50);
      const labels = panel.bars ? panel.bars.names : this.yTicks.map(([, label]) => label);
      const left = 24 + Math.max(10, ...labels.map((label) => pen.measureText(label).width));
      const names = panel.x.names ? Math.max(...panel.x.names.map((name) => pen.measureText(name).width)) : 0;
      this.turned = panel.x.names && names > (wide - left) / panel.x.names.length - 6;
      const below = 36 + (this.turned ? names - 8 : 0), right = panel.colour ? 84 : 14;
      this.box = { left, top: 8, width: wide - left - right, height: sheet.height - below - 8, right: wide - right };
      this.box.bottom = this.box.top + this.box.height;
      pen.save();
      pen.beginPath();
      pen.rect(left, this.box.top, this.box.width, this.box.height);
      pen.clip();
      this.drawData();
      pen.restore();
      this.drawFrame();
      if (panel.colour) this.drawColours();
    }

    drawData() {
      const { panel } = this;
      if (panel.map) this.drawMap(panel.map);
      else this.drawGrid();
      for (const band of panel.bands || []) this.area([[band.from, null], [band.to, null]], band.colour, 0.18);
      for (const ribbon of panel.ribbons || []) this.drawRibbon(ribbon);
      for (const series of panel.series || []) this.drawSeries(series);
      if (panel.bars) this.drawBars(panel.bars);
      for (const line of panel.lines || []) this.drawRule(line);
    }

    drawGrid() {
      const { pen } = this.sheet, b = this.box;
      pen.strokeStyle = this.figure.faint;
      pen.lineWidth = 1;
      pen.beginPath();
      for (const [value] of this.xTicks) {
        const x = b.left + this.share("x", value) * b.width;
        pen.moveTo(x, b.top), pen.lineTo(x, b.bottom);
      }
      for (const [value] of this.yTicks) {
        const y = b.bottom - this.share("y", value) * b.height;
        pen.moveTo(b.left, y), pen.lineTo(b.right, y);
      }
      pen.stroke();
    }

    area([[from], [to]], colour, alpha) {
      const { pen } = this.sheet, b = this.box;
      const x = b.left + this.share("x", from) * b.width;
      pen.globalAlpha = alpha;
      pen.fillStyle = colour;
      pen.fillRect(x, b.top, (this.share("x", to) - this.share("x", from)) * b.width, b.height);
      pen.globalAlpha = 1;
    }

    drawRibbon(ribbon) {
      const { pen } = this.sheet;
      pen.fillStyle = ribbon.colour;
      pen.globalAlpha = 0.35;
      const clamp = ([x, y]) => [x, Math.min(this.box.bottom + 9, Math.max(this.box.top - 9, y))];
      pen.beginPath();
      for (let i = 1; i < ribbon.x.length; ++i) {
        const low = this.panel.y.log ? Math.max(1e-300, ribbon.low[i]) : ribbon.low[i];
        const before = this.panel.y.log ? Math.max(1e-300, ribbon.low[i - 1]) : ribbon.low[i - 1];
        const corners = [[ribbon.x[i - 1], before], [ribbon.x[i], low], [ribbon.x[i], ribbon.high[i]],
          [ribbon.x[i - 1], ribbon.high[i - 1]]];
        if (corners.some(([x, y]) => x === null || y === null)) continue;
        const placed = corners.map(([x, y]) => clamp(this.at(x, y)));
        if (placed.flat().every(finite)) placed.forEach((p, k) => (k ? pen.lineTo(...p) : pen.moveTo(...p)));
      }
      pen.fill();
      pen.globalAlpha = 1;
    }

    drawSeries(s) {
      const { pen } = this.sheet;
      if (s.style === "columns") return this.drawColumns(s);
      pen.strokeStyle = pen.fillStyle = s.colour;
      pen.lineWidth = 1.5 * s.width;
      pen.setLineDash(dashes[s.style] || []);
      if (s.style === "stems") this.drawStems(s);
      if (hasLine(s.style)) s.c ? this.drawColouredLine(s) : this.drawLine(s);
      pen.setLineDash([]);
      if (hasPoints(s.style)) this.drawPoints(s);
    }

    drawLine(s) {
      const { pen } = this.sheet;
      let down = false;
      pen.beginPath();
      for (let i = 0; i < s.x.length; ++i) {
        const [x, y] = s.x[i] === null || s.y[i] === null ? [NaN, NaN] : this.at(s.x[i], s.y[i]);
        if (!finite(x) || !finite(y)) down = false;
        else if (down) pen.lineTo(x, y);
        else pen.moveTo(x, y), (down = true);
      }
      pen.stroke();
    }

    drawColouredLine(s) {
      const { pen } = this.sheet, axis = this.panel.colour;
      for (let i = 1; i < s.x.length; ++i) {
        if ([s.x[i - 1], s.y[i - 1], s.x[i], s.y[i], s.c[i]].includes(null)) continue;
        pen.strokeStyle = rgb(mixed(axis.palette, placeOn(axis, s.c[i])));
        pen.beginPath();
        pen.moveTo(...this.at(s.x[i - 1], s.y[i - 1]));
        pen.lineTo(...this.at(s.x[i], s.y[i]));
        pen.stroke();
      }
    }

    drawPoints(s) {
      const { pen } = this.sheet, axis = this.panel.colour, r = (s.x.length > 1000 ? 1.3 : 2) * s.width;
      for (let i = 0; i < s.x.length; ++i) {
        if (s.x[i] === null || s.y[i] === null) continue;
        const [x, y] = this.at(s.x[i], s.y[i]);
        if (!finite(x + y)) continue;
        if (s.c) pen.fillStyle = rgb(mixed(axis.palette, placeOn(axis, s.c[i])));
        pen.beginPath();
        pen.arc(x, y, r, 0, 2 * Math.PI);
        pen.fill();
      }
    }

    ground() { return this.panel.y.log ? this.box.bottom : this.at(this.view.x[0], 0)[1]; }

    drawStems(s) {
      const { pen } = this.sheet;
      pen.beginPath();
      for (let i = 0; i < s.x.length; ++i) {
        const [x, y] = this.at(s.x[i], s.y[i]);
        pen.moveTo(x, this.ground()), pen.lineTo(x, y);
      }
      pen.stroke();
    }

    drawColumns(s) {
      const { pen } = this.sheet;
      const half = s.x.length > 1 ? Math.abs(s.x[1] - s.x[0]) / 2 : 0.5;
      pen.fillStyle = s.colour;
      pen.globalAlpha = 0.7;
      for (let i = 0; i < s.x.length; ++i) {
        const [a, y] = this.at(s.x[i] - half, s.y[i]), [b] = this.at(s.x[i] + half, s.y[i]);
        pen.fillRect(a + 0.5, Math.min(y, this.ground()), b - a - 1, Math.abs(this.ground() - y));
      }
      pen.globalAlpha = 1;
    }

    drawRule(line) {
      const { pen } = this.sheet, b = this.box;
      pen.strokeStyle = line.colour;
      pen.lineWidth = 1.5;
      pen.setLineDash(dashes[line.style] || []);
      pen.beginPath();
      if (line.vertical) {
        const x = b.left + this.share("x", line.value) * b.width;
        pen.moveTo(x, b.top), pen.lineTo(x, b.bottom);
      } else {
        const y = b.bottom - this.share("y", line.value) * b.height;
        pen.moveTo(b.left, y), pen.lineTo(b.right, y);
      }
      pen.stroke();
      pen.setLineDash([]);
    }

    drawMap(map) {
      const { pen } = this.sheet, axis = this.panel.colour;
      map.z.forEach((row, r) => row.forEach((value, c) => {
        const [x0, y0] = this.at(map.x[c], map.y[r]), [x1, y1] = this.at(map.x[c + 1], map.y[r + 1]);
        const colour = value === null ? null : mixed(axis.palette, placeOn(axis, value));
        pen.fillStyle = colour ? rgb(colour) : this.figure.no_data;
        pen.fillRect(x0, y1, x1 - x0 + 0.5, y0 - y1 + 0.5);
        if (!colour) this.hatch(x0, y1, x1 - x0, y0 - y1);
        if (map.numbers && colour) {
          const bright = 0.21 * colour[0] + 0.72 * colour[1] + 0.07 * colour[2] > 140;
          this.sheet.text(minus(String(+(value / axis.factor).toPrecision(2))), (x0 + x1) / 2, (y0 + y1) / 2, "center", "middle",
            bright ? "#141414" : "#fafafa");
        }
      }));
    }

    hatch(x, y, width, height) {
      const { pen } = this.sheet, gap = 9;
      pen.save();
      pen.beginPath();
      pen.rect(x, y, width, height);
      pen.clip();
      pen.strokeStyle = this.figure.hatch;
      pen.lineWidth = 0.8;
      pen.beginPath();
      for (let k = Math.ceil((x + y) / gap) * gap; k < x + y + width + height; k += gap) {
        pen.moveTo(k - y, y), pen.lineTo(k - y - height, y + height);
      }
      pen.stroke();
      pen.restore();
    }

    drawBars(bars) {
      const { sheet, box: b } = this, { pen } = sheet, rows = bars.names.length, each = b.height / rows;
      bars.sets.forEach((set, k) => set.value.forEach((value, i) => {
        if (value === null) return;
        const thick = (0.72 * each) / bars.sets.length, top = b.top + i * each + 0.14 * each + k * thick;
        const zero = b.left + Math.min(1, Math.max(0, this.panel.x.log ? 0 : this.share("x", 0))) * b.width;
        const x = b.left + this.share("x", value) * b.width;
        pen.fillStyle = set.colour;
        pen.fillRect(Math.min(zero, x), top, Math.abs(x - zero), 0.92 * thick);
        const label = minus(String(+(value / this.panel.x.factor).toPrecision(3)));
        const within = value >= 0 && x + 5 + pen.measureText(label).width > b.right;  // no room beyond the bar
        const leftward = value < 0 || within;
        sheet.text(label, x + (leftward ? -5 : 5), top + thick / 2, leftward ? "right" : "left", "middle",
          within ? this.figure.paper : this.figure.ink);
      }));
    }

    drawFrame() {
      const { sheet, box: b, panel, figure } = this, { pen } = sheet;
      pen.strokeStyle = figure.ink;
      pen.lineWidth = 1;
      pen.strokeRect(b.left, b.top, b.width, b.height);
      let end = -1e9;
      for (const [value, label] of this.xTicks) {
        const x = b.left + this.share("x", value) * b.width, half = pen.measureText(label).width / 2;
        if (this.turned) sheet.text(label, x, b.bottom + 6, "right", "middle", figure.ink, true);
        else if (x - half > end + 6) sheet.text(label, x, b.bottom + 6, "center", "top", figure.ink), (end = x + half);
      }
      for (const [value, label] of this.yTicks)
        sheet.text(label, b.left - 6, b.bottom - this.share("y", value) * b.height, "right", "middle", figure.ink);
      if (panel.bars)
        panel.bars.names.forEach((name, i) =>
          sheet.text(name, b.left - 6, b.top + ((i + 0.5) * b.height) / panel.bars.names.length, "right", "middle", figure.ink));
      sheet.text(panel.x.title, b.left + b.width / 2, sheet.height - 3, "center", "bottom", figure.ink);
      sheet.text(panel.y.title, 3, b.top + b.height / 2, "center", "top", figure.ink, true);
    }

    drawColours() {
      const { sheet, box: b, figure } = this, axis = this.panel.colour, { pen } = sheet, left = b.right + 10;
      for (let i = 0; i < 64; ++i) {
        pen.fillStyle = rgb(mixed(axis.palette, (i + 0.5) / 64));
        pen.fillRect(left, b.bottom - ((i + 1) * b.height) / 64, 12, b.height / 64 + 0.6);
      }
      for (const [value, label] of ticksOf(axis, axis.min, axis.max, 5))
        sheet.text(label, left + 16, b.bottom - placeOn(axis, value) * b.height, "left", "middle", figure.ink);
      sheet.text(axis.title, sheet.width - 2, b.top + b.height / 2, "center", "bottom", figure.ink, true);
    }

    // ---- zoom ----

    zoomed(name, share, factor) {
      const low = this.value(name, share * (1 - factor)), high = this.value(name, share + (1 - share) * factor);
      if (high > low && finite(high - low) && high - low > 1e-12 * Math.abs(high + low)) this.view[name] = [low, high];
    }

    listen() {
      const canvas = this.sheet.canvas;
      const place = (event) => {
        const b = this.box;
        return [(event.offsetX - b.left) / b.width, (b.bottom - event.offsetY) / b.height];
      };
      canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        const [x, y] = place(event), factor = Math.exp(0.002 * event.deltaY);
        this.zoomed("x", x, factor);
        if (!this.panel.bars && !event.shiftKey) this.zoomed("y", y, factor);
        this.draw();
      }, { passive: false });
      canvas.addEventListener("pointerdown", (event) => {
        this.start = { at: place(event), pan: event.shiftKey, view: structuredClone(this.view) };
        canvas.setPointerCapture(event.pointerId);
      });
      canvas.addEventListener("pointermove", (event) => this.drag(place(event)));
      canvas.addEventListener("pointerup", (event) => this.drop(place(event)));
      canvas.addEventListener("dblclick", () => (this.reset(), this.draw()));
    }

    drag([x, y]) {
      if (!this.start) return this.point(x, y);
      if (this.start.pan) {
        this.view = structuredClone(this.start.view);
        const moved = { x: this.start.at[0] - x, y: this.start.at[1] - y };
        for (const name of this.panel.bars ? ["x"] : ["x", "y"])
          this.view[name] = [this.value(name, moved[name]), this.value(name, 1 + moved[name])];
        return this.draw();
      }
      this.draw();
      const { pen } = this.sheet, b = this.box, [u, v] = this.start.at;
      pen.fillStyle = "rgba(0,114,178,0.15)";
      pen.fillRect(b.left + Math.min(u, x) * b.width, b.bottom - Math.max(v, y) * b.height, Math.abs(x - u) * b.width,
        Math.abs(y - v) * b.height);
    }

    drop([x, y]) {
      const start = this.start;
      this.start = null;
      if (!start || start.pan) return;
      const [u, v] = start.at;
      if (Math.abs(x - u) > 0.02 && Math.abs(y - v) > 0.02) {
        const view = { x: [this.value("x", Math.min(u, x)), this.value("x", Math.max(u, x))],
          y: [this.value("y", Math.min(v, y)), this.value("y", Math.max(v, y))] };
        this.view = this.panel.bars ? { x: view.x, y: this.view.y } : view;
      }
      this.draw();
    }

    // What the pointer is at, above the chart on the right.
    point(x, y) {
      if (!this.readout || !this.box || this.panel.bars) return;
      const words = (name, share) => minus(String(+(this.value(name, share) / this.panel[name].factor).toPrecision(4)));
      this.readout.textContent = x >= 0 && x <= 1 && y >= 0 && y <= 1 ? `${words("x", x)}, ${words("y", y)}` : "";
    }
  }

  // ---- surfaces ----

  class Space {
    constructor(parent, figure, panel) {
      this.figure = figure;
      this.scene = panel.scene;
      this.sheet = new Sheet(parent, 420);
      this.size = [1, 1, 0.72];
      this.reset();
      this.listen();
    }

    reset() { Object.assign(this, { azimuth: this.scene.azimuth, elevation: this.scene.elevation, zoom: 1 }); }

    inBox(x, y, z) {
      return [x, y, z].map((value, k) => {
        const axis = this.scene.axes[k];
        return ((value - axis.min) / (axis.max - axis.min) - 0.5) * this.size[k];
      });
    }

    aim() {
      const a = (this.azimuth * Math.PI) / 180, e = (this.elevation * Math.PI) / 180;
      this.toward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
      this.right = [-Math.sin(a), Math.cos(a), 0];
      this.up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
      this.scale = this.zoom * Math.min((this.sheet.width - 150) / 1.45, (this.sheet.height - 80) / 1.3);
      this.centre = [this.sheet.width / 2, this.sheet.height / 2 - 6];
    }

    at(p) {
      const dot = (d) => p[0] * d[0] + p[1] * d[1] + p[2] * d[2];
      return [this.centre[0] + this.scale * dot(this.right), this.centre[1] - this.scale * dot(this.up)];
    }

    draw() {
      this.sheet.clear(this.figure);
      this.aim();
      this.drawAxes();
      this.drawSurface();
    }

    line(a, b, colour, width) {
      const { pen } = this.sheet;
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.beginPath();
      pen.moveTo(...this.at(a));
      pen.lineTo(...this.at(b));
      pen.stroke();
    }

    near(k) { return (this.toward[k] >= 0 ? 0.5 : -0.5) * this.size[k]; }

    drawAxes() {
      const { axes } = this.scene, far = [-this.near(0), -this.near(1), -0.36];
      const ticks = axes.map((axis) => ticksOf(axis, axis.min, axis.max, 5));
      const place = (k, value) => ((value - axes[k].min) / (axes[k].max - axes[k].min) - 0.5) * this.size[k];
      for (let flat = 0; flat < 3; ++flat)
        for (const [run, across] of [[(flat + 1) % 3, (flat + 2) % 3], [(flat + 2) % 3, (flat + 1) % 3]])
          for (const [value] of ticks[across]) {
            const a = [...far], b = [...far];
            a[across] = b[across] = place(across, value);
            a[run] = -0.5 * this.size[run];
            b[run] = 0.5 * this.size[run];
            this.line(a, b, this.figure.faint, 1);
          }
      const first = [this.near(0), -this.near(1), 0], second = [-this.near(0), this.near(1), 0];
      const upright = this.at(first)[0] < this.at(second)[0] ? first : second;
      this.axis(0, [0, this.near(1), -0.36], ticks[0], place);
      this.axis(1, [this.near(0), 0, -0.36], ticks[1], place);
      this.axis(2, upright, ticks[2], place);
    }

    axis(k, from, ticks, place) {
      const a = [...from], b = [...from], { sheet, figure } = this;
      a[k] = -0.5 * this.size[k];
      b[k] = 0.5 * this.size[k];
      this.line(a, b, figure.ink, 1);
      const middle = [...from];
      middle[k] = 0;
      const home = this.at(k === 2 ? middle : [middle[0], middle[1], -0.36]), origin = this.at([0, 0, k === 2 ? 0 : -0.36]);
      const length = Math.hypot(home[0] - origin[0], home[1] - origin[1]) || 1;
      const out = k === 2 ? [-1, 0] : [(home[0] - origin[0]) / length, (home[1] - origin[1]) / length];
      for (const [value, label] of ticks) {
        const at = [...from];
        at[k] = place(k, value);
        const p = this.at(at);
        sheet.text(label, p[0] + 18 * out[0], p[1] + 12 * out[1], "center", "middle", figure.ink);
      }
      sheet.text(this.scene.axes[k].title, home[0] + 52 * out[0], home[1] + 34 * out[1], "center", "middle", figure.ink, k === 2);
    }

    drawSurface() {
      const { scene } = this, rows = scene.y.length - 1, columns = scene.x.length - 1;
      const node = scene.z.map((row, r) => row.map((z, c) => (z === null ? null : this.inBox(scene.x[c], scene.y[r], z))));
      const dots = this.sortDots();
      for (let i = 0; i < rows; ++i)
        for (let j = 0; j < columns; ++j) {
          const r = this.toward[1] >= 0 ? i : rows - 1 - i, c = this.toward[0] >= 0 ? j : columns - 1 - j;
          const mine = dots.get(r * columns + c) || [];
          this.drawDots(mine.filter((dot) => dot.height < 0));
          this.drawCell(r, c, node);
          this.drawDots(mine.filter((dot) => dot.height >= 0));
        }
    }

    drawCell(r, c, node) {
      const corners = [node[r][c], node[r][c + 1], node[r + 1][c + 1], node[r + 1][c]];
      if (corners.includes(null)) return;
      const { pen } = this.sheet, { scene } = this, z = scene.z;
      const value = (z[r][c] + z[r][c + 1] + z[r + 1][c + 1] + z[r + 1][c]) / 4;
      const u = [0, 1, 2].map((k) => corners[2][k] - corners[0][k]), v = [0, 1, 2].map((k) => corners[3][k] - corners[1][k]);
      const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const length = Math.hypot(...n) || 1;
      const light = [0, 1, 2].reduce((sum, k) =>
        sum + (n[k] / length) * (0.85 * this.toward[k] - 0.35 * this.right[k] + 0.39 * this.up[k]), 0);
      const strength = 0.62 + 0.42 * Math.abs(light);
      const colour = mixed(scene.palette, (value - scene.low) / (scene.high - scene.low));
      pen.fillStyle = pen.strokeStyle = rgb(colour.map((part) => Math.min(255, Math.round(strength * part))));
      pen.lineWidth = 0.7;
      pen.beginPath();
      corners.forEach((p, k) => (k ? pen.lineTo(...this.at(p)) : pen.moveTo(...this.at(p))));
      pen.closePath();
      pen.fill();
      pen.stroke();
    }

    // Each point of the clouds by the cell that it stands on, with its height above the surface.
    sortDots() {
      const { scene } = this, columns = scene.x.length - 1, dots = new Map();
      const cell = (nodes, value) => {
        let low = 0, high = nodes.length - 1;
        while (high - low > 1) {
          const middle = (low + high) >> 1;
          if (nodes[middle] <= value) low = middle;
          else high = middle;
        }
        return low;
      };
      for (const cloud of scene.clouds)
        for (let i = 0; i < cloud.x.length; ++i) {
          const [x, y, z] = [cloud.x[i], cloud.y[i], cloud.z[i]];
          if (x === null || y === null || z === null) continue;
          const r = cell(scene.y, y), c = cell(scene.x, x), grid = scene.z;
          const u = (x - scene.x[c]) / (scene.x[c + 1] - scene.x[c]), v = (y - scene.y[r]) / (scene.y[r + 1] - scene.y[r]);
          const corners = [grid[r][c], grid[r][c + 1], grid[r + 1][c], grid[r + 1][c + 1]];
          const surface = corners.includes(null) ? z
            : (1 - v) * ((1 - u) * corners[0] + u * corners[1]) + v * ((1 - u) * corners[2] + u * corners[3]);
          const key = r * columns + c;
          if (!dots.has(key)) dots.set(key, []);
          dots.get(key).push({ at: this.inBox(x, y, z), height: z - surface, colour: cloud.colour });
        }
      return dots;
    }

    drawDots(dots) {
      const { pen } = this.sheet;
      for (const dot of dots) {
        pen.fillStyle = dot.colour;
        pen.beginPath();
        pen.arc(...this.at(dot.at), 1.8, 0, 2 * Math.PI);
        pen.fill();
      }
    }

    listen() {
      const canvas = this.sheet.canvas;
      canvas.addEventListener("pointerdown", (event) => {
        this.last = [event.clientX, event.clientY];
        canvas.setPointerCapture(event.pointerId);
      });
      canvas.addEventListener("pointermove", (event) => {
        if (!this.last) return;
        this.azimuth -= 0.5 * (event.clientX - this.last[0]);
        this.elevation = Math.min(85, Math.max(5, this.elevation + 0.4 * (event.clientY - this.last[1])));
        this.last = [event.clientX, event.clientY];
        this.draw();
      });
      canvas.addEventListener("pointerup", () => (this.last = null));
      canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        this.zoom = Math.min(8, Math.max(0.5, this.zoom * Math.exp(-0.001 * event.deltaY)));
        this.draw();
      }, { passive: false });
      canvas.addEventListener("dblclick", () => (this.reset(), this.draw()));
    }
  }

  // ---- pages ----

  function element(parent, kind, style, words) {
    const made = document.createElement(kind);
    made.style.cssText = style;
    if (words) made.textContent = words;
    parent.append(made);
    return made;
  }

  function legendEntries(panel) {
    const entries = [], add = (label, colour, style) => {
      if (label && !entries.some((entry) => entry.label === label)) entries.push({ label, colour, style });
    };
    for (const s of panel.series || []) add(s.label, s.colour, s.style);
    for (const set of panel.bars ? panel.bars.sets : []) add(set.label, set.colour, "area");
    for (const area of [...(panel.ribbons || []), ...(panel.bands || [])]) add(area.label, area.colour, "area");
    for (const line of panel.lines || []) add(line.label, line.colour, line.style);
    if (panel.map && panel.map.z.some((row) => row.includes(null))) add(panel.map.missing, panel.colour.palette[0], "hatch");
    for (const cloud of panel.scene ? panel.scene.clouds : []) add(cloud.label, cloud.colour, "points");
    return entries;
  }

  function drawLegend(parent, panel) {
    const border = { dashed: "dashed", dotted: "dotted", dash_dot: "dashed" };
    for (const entry of legendEntries(panel)) {
      const item = element(parent, "span", "margin-right:1em;white-space:nowrap");
      const swatch = entry.style === "points" ? `width:6px;height:6px;border-radius:50%;background:${entry.colour}`
        : entry.style === "hatch" ? "width:12px;height:12px;background:repeating-linear-gradient(135deg,#ddd 0 2px,#999 2px 3px)"
        : entry.style === "area" || entry.style === "columns" ? `width:18px;height:9px;opacity:.5;background:${entry.colour}`
        : `width:22px;height:0;border-top:2.5px ${border[entry.style] || "solid"} ${entry.colour}`;
      element(item, "span", `display:inline-block;vertical-align:middle;margin-right:.4em;${swatch}`);
      item.append(entry.label);
    }
  }

  function build(holder) {
    const figure = JSON.parse(holder.querySelector("script").textContent);
    const picture = holder.querySelector("img");
    const frame = element(holder, "div", `background:${figure.paper};color:${figure.ink};font:13px system-ui,sans-serif`);
    if (picture) picture.remove();
    holder.style.minHeight = "";
    if (figure.title) element(frame, "div", "font-weight:bold;padding:.4em 0", figure.title);
    const grid = element(frame, "div", `display:grid;gap:.8em;grid-template-columns:repeat(${figure.columns},minmax(0,1fr))`);
    const drawn = figure.panels.map((panel) => {
      const cell = element(grid, "div", `grid-column:span ${Math.min(panel.span, figure.columns)};min-width:0`);
      const head = element(cell, "div", "display:flex;gap:1em;min-height:1.2em");
      element(head, "b", "flex:1", panel.title);
      const readout = element(head, "span", "font-variant-numeric:tabular-nums;opacity:.7");
      if (panel.note) element(head, "span", "", panel.note);
      drawLegend(element(cell, "div", ""), panel);
      const chart = panel.scene ? new Space(cell, figure, panel) : new Chart(cell, figure, panel);
      chart.readout = readout;
      chart.draw();
      return chart;
    });
    new ResizeObserver(() => drawn.forEach((chart) => chart.draw())).observe(frame);
    holder.dataset.drawn = drawn.length;
  }

  // A report may hold hundreds: each is drawn when it comes near the view, and all of them before they are printed.
  const waiting = new Set(document.querySelectorAll(".lunid-figure"));
  const show = (holder) => waiting.delete(holder) && (observer.unobserve(holder), build(holder));
  const observer = new IntersectionObserver((entries) => entries.forEach((entry) => entry.isIntersecting && show(entry.target)),
    { rootMargin: "1000px" });
  for (const holder of waiting) {
    if (!holder.querySelector("img")) holder.style.minHeight = "300px";
    observer.observe(holder);
  }
  window.addEventListener("beforeprint", () => [...waiting].forEach(show));
  document.documentElement.dataset.ready = "yes";
})();
