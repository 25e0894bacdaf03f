"use strict";
// Plots, drawn by Plotly when they come into view. A method has one colour on the whole page; where a plot shows it twice, marker and dash tell.

const METHOD_COLOURS = 10; // as many as page.css has
const MARKERS = ["circle", "square", "diamond", "triangle-up", "cross", "triangle-down", "star"];
const DASHES = ["dash", "dot", "dashdot", "longdash"];
const PATTERNS = ["", "/", ".", "x", "-", "\\"];

/** A method's colour as a CSS value: the text's for references. */
function methodColour(method) {
  const index = window.lampyris.methods.indexOf(method);
  return index < 0 ? "var(--text)" : `var(--method-${index % METHOD_COLOURS})`;
}

const plots = (() => {
  const probe = document.createElement("span");
  probe.hidden = true;
  document.body.append(probe);

  /** A CSS colour as rgb(...), in the theme of now: Plotly knows no variables. */
  function resolved(colour, alpha = 1) {
    probe.style.color = colour;
    const value = getComputedStyle(probe).color;
    return alpha === 1 ? value : value.replace(/^rgb\((.*)\)$/, `rgba($1, ${alpha})`);
  }

  const escaped = (text) => String(text).replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");

  /** Text broken into lines, for a hover label is as wide as its text. */
  function wrapped(text, width = 44) {
    const lines = [];
    for (const line of String(text).split(/\n|<br>/)) {
      let current = "";
      for (const word of line.split(" ")) {
        if (current && current.length + word.length >= width) {
          lines.push(current);
          current = "";
        }
        current += (current ? " " : "") + word;
      }
      lines.push(current);
    }
    return lines.map(escaped).join("<br>");
  }

  /** The exponents of ten that a logarithmic axis goes over; bands that reach zero go beyond its lower end. */
  function logRange(values) {
    const positive = values.filter((value) => value > 0).map(Math.log10);
    if (!positive.length) return undefined;
    const low = positive.reduce((a, b) => Math.min(a, b)), high = positive.reduce((a, b) => Math.max(a, b));
    const margin = 0.06 * Math.max(high - low, 0.5);
    return [low - margin, high + margin];
  }

  /** The band of a series: there and back as one outline. */
  function band(series, colour, floor) {
    const there = [];
    series.x.forEach((x, i) => {
      if (series.low?.[i] != null && series.high?.[i] != null) there.push([x, Math.max(series.low[i], floor), series.high[i]]);
    });
    const back = [...there].reverse();
    return {
      type: "scatter",
      mode: "lines",
      x: [...there, ...back].map((point) => point[0]),
      y: [...there.map((point) => point[1]), ...back.map((point) => point[2])],
      fill: "toself",
      fillcolor: resolved(colour, 0.18),
      line: { width: 0 },
      hoverinfo: "skip",
      showlegend: false,
    };
  }

  /** Plotly's traces, and for each the series that it shows. */
  function traces(plot, yRange) {
    const seen = new Map();
    const found = [];
    plot.series.forEach((series, index) => {
      const times = seen.get(series.method + series.style) ?? 0;
      seen.set(series.method + series.style, times + 1);
      const place = Math.max(0, window.lampyris.methods.indexOf(series.method));
      const css = methodColour(series.method);
      const colour = resolved(css);
      const legendgroup = `series-${index}`;
      const settings = (series.hover ?? []).map((text) => wrapped(text));
      const common = {
        name: escaped(series.name),
        legendgroup,
        legendrank: index,
        x: series.x,
        y: series.y,
        customdata: series.x.map((_, i) => settings[i] ?? ""),
        hovertemplate:
          `<b>${wrapped(series.name)}</b><br>${escaped(plot.x.title)}: %{x}<br>${escaped(plot.y.title)}: %{y:.4~g}` +
          "<br>%{customdata}<extra></extra>",
      };
      if (plot.bars) {
        const errors = series.low && series.high && plot.bars === "group" && {
          type: "data",
          symmetric: false,
          array: series.y.map((y, i) => series.high[i] - y),
          arrayminus: series.y.map((y, i) => y - series.low[i]),
          color: resolved("var(--text)"),
          thickness: 1.2,
        };
        const shape = PATTERNS[(Math.floor(place / METHOD_COLOURS) + times) % PATTERNS.length];
        const marker = { color: colour, pattern: { shape, fillmode: "overlay", size: 6 } };
        found.push([{ ...common, type: "bar", marker, ...(errors ? { error_y: errors } : {}) }, series]);
        return;
      }
      if (series.low && series.high) found.push([{ ...band(series, css, yRange ? 10 ** (yRange[0] - 1) : -Infinity), legendgroup }, null]);
      const dashed = series.style === "dash";
      found.push([{
        ...common,
        type: "scatter",
        mode: dashed ? "lines" : series.style === "points" ? "markers" : "lines+markers",
        line: { color: colour, width: dashed ? 1.6 : 2, dash: dashed ? DASHES[times % DASHES.length] : "solid" },
        marker: { color: colour, size: 7, symbol: MARKERS[(place + times) % MARKERS.length] },
      }, series]);
    });
    const layer = ([trace, series]) => (series === null ? 0 : series.style === "dash" && !plot.bars ? 1 : 2);
    return found.sort((one, other) => layer(one) - layer(other)); // bands, then predictions, then what was measured on top
  }

  function axis(declared, range) {
    const line = resolved("var(--line)");
    return {
      title: { text: escaped(declared.title), standoff: 8 },
      type: declared.log ? "log" : undefined,
      range,
      exponentformat: "power",
      nticks: declared.log ? 4 : undefined, // more, and numbers between the powers of ten crowd
      gridcolor: line,
      linecolor: line,
      zerolinecolor: line,
      zeroline: !declared.log,
      ticks: "outside",
      tickcolor: line,
      automargin: true,
      minor: declared.log ? { ticks: "outside", ticklen: 3, tickcolor: line } : undefined,
    };
  }

  const touch = matchMedia("(pointer: coarse)");

  function layout(plot, area, yRange, xRange) {
    const text = resolved("var(--text)");
    return {
      paper_bgcolor: "rgba(0,0,0,0)",
      plot_bgcolor: "rgba(0,0,0,0)",
      font: { family: getComputedStyle(document.body).fontFamily, size: 12.5, color: text },
      margin: { l: 52, r: 10, t: 26, b: 44 },
      height: area.clientHeight,
      xaxis: { ...axis(plot.x, xRange), ...(plot.bars ? { type: "category" } : {}) },
      yaxis: axis(plot.y, yRange),
      barmode: plot.bars === "stack" ? "stack" : "group",
      bargap: 0.25,
      showlegend: plot.series.length > 1,
      legend: { orientation: "h", yref: "container", y: 0, yanchor: "bottom", x: 0, xanchor: "left", tracegroupgap: 0, font: { size: 12 } },
      hovermode: "closest",
      hoverlabel: {
        bgcolor: resolved("var(--card)"),
        bordercolor: resolved("var(--line)"),
        font: { color: text, size: 12 },
        align: "left",
        namelength: -1,
      },
      dragmode: touch.matches ? false : "zoom", // a finger scrolls the page until it asks to zoom, with the button above the plot
      modebar: { bgcolor: "rgba(0,0,0,0)", color: resolved("var(--quiet)"), activecolor: resolved("var(--accent)") },
      uirevision: "kept", // zoom and hidden series outlive a change of theme
    };
  }

  /** Draw a plot, or draw it again in other colours. */
  function draw(area) {
    const plot = window.lampyris.plots[area.dataset.plot];
    const all = (axis, more) => plot.series.flatMap((series) => [series[axis], ...more.map((key) => series[key] ?? [])]).flat();
    const yRange = plot.y.log && !plot.bars ? logRange(all("y", ["low", "high"])) : undefined;
    const xRange = plot.x.log && !plot.bars ? logRange(all("x", [])) : undefined;
    const first = !area.dataset.drawn;
    if (first) {
      const names = plot.series.reduce((sum, series) => sum + 46 + 6.8 * series.name.length, 0);
      const rows = plot.series.length > 1 ? Math.ceil((1.3 * names) / (area.clientWidth - 70)) : 0;
      area.style.height = `${area.clientHeight + 19 * Math.max(0, rows - 1)}px`;
      area.dataset.drawn = "yes";
    }
    const shown = traces(plot, yRange);
    Plotly.react(area, shown.map(([trace]) => trace), layout(plot, area, yRange, xRange), {
      responsive: true,
      displaylogo: false,
      displayModeBar: touch.matches ? true : "hover",
      modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
      showSendToCloud: false, // Plotly 4 would offer to upload the data
      plotlyServerURL: "",
      doubleClick: "reset",
      toImageButtonOptions: { format: "svg", filename: plot.key },
    });
    if (!first) return;
    area.on("plotly_click", ({ points: [point] }) => {
      const series = shown[point.curveNumber][1];
      const keys = series?.runs?.[point.pointNumber];
      if (keys?.length) runs.show(series.name, keys);
    });
  }

  const areas = [...document.querySelectorAll("[data-plot]")];
  const drawn = () => areas.filter((area) => area.dataset.drawn);
  const observer = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (!isIntersecting) continue;
      observer.unobserve(target);
      draw(target);
    }
  }, { rootMargin: "300px" });
  areas.forEach((area) => observer.observe(area));
  theme.listeners.push(() => drawn().forEach(draw));

  return { drawAll: () => areas.forEach(draw) };
})();
