"use strict";
// Sorts tables by a column, hides and shows layers of figures, and turns views in space. Reads nothing but this page.
{
  const make = (name, attributes = {}, ...children) => {
    const element = document.createElement(name);
    Object.assign(element, attributes);
    element.append(...children);
    return element;
  };

  const compare = (a, b, numeric) => {
    if (!numeric) return a.localeCompare(b, "en", { numeric: true });
    const [x, y] = [a, b].map((text) => Number.parseFloat(text.replace(/[^0-9.eE+-]/g, "")));
    if (Number.isNaN(x) || Number.isNaN(y)) return Number(Number.isNaN(x)) - Number(Number.isNaN(y));
    return x - y;
  };

  for (const table of document.querySelectorAll("figure.table table")) {
    const body = table.tBodies[0];
    if (body.rows.length < 3) continue;
    const heads = [...table.tHead.rows[0].cells];
    heads.forEach((head, column) => {
      // Above the text and not around it: Chromium does not print controls in the repeated heads of long tables.
      const label = `Sort by ${head.textContent.trim()}`;
      const button = make("button", { type: "button", title: label, ariaLabel: label });
      head.append(button);
      button.addEventListener("click", () => {
        const down = head.getAttribute("aria-sort") === "ascending";
        for (const other of heads) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", down ? "descending" : "ascending");
        const numeric = head.classList.contains("number");
        const key = (row) => row.cells[column].textContent;
        const rows = [...body.rows].sort((a, b) => compare(key(a), key(b), numeric));
        body.append(...(down ? rows.reverse() : rows));
      });
    });
  }

  const checkboxes = (names, shown, changed) => {
    const box = (name, i) => {
      const input = make("input", { type: "checkbox", checked: shown(i) });
      input.addEventListener("change", () => changed(name, i, input.checked));
      return make("label", {}, input, " " + name);
    };
    return make("div", { className: "layers" }, ...names.map(box));
  };

  for (const figure of document.querySelectorAll("figure.picture")) {
    const svg = figure.querySelector(":scope > svg");
    const layers = svg ? [...svg.querySelectorAll("[data-layer]")] : [];
    const names = [...new Set(layers.map((layer) => layer.dataset.layer))];
    if (names.length < 2) continue;
    svg.after(checkboxes(names, () => true, (name, _, on) => {
      for (const layer of layers) if (layer.dataset.layer === name) layer.style.display = on ? "" : "none";
    }));
  }

  const SVG = "http://www.w3.org/2000/svg";
  const turnable = (place) => {
    const { layers } = JSON.parse(place.querySelector("script").textContent);
    const points = layers.flatMap((layer) => layer.lines.flat());
    const middle = [0, 1, 2].map((axis) => {
      const values = points.map((point) => point[axis]);
      return (Math.min(...values) + Math.max(...values)) / 2;
    });
    const reach = Math.max(...points.map((p) => Math.hypot(...p.map((v, i) => v - middle[i])))) * 1.04;
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", `${-reach} ${-reach} ${2 * reach} ${2 * reach}`);
    svg.setAttribute("role", "img");
    svg.setAttribute("aria-label", "The spine in space; drag to turn");
    const on = layers.map((layer) => layer.shown);
    // From behind, a little from the right and from above.
    let [yaw, pitch] = [0.6, 0.25];
    const project = ([x, y, z]) => {
      const [a, b, c] = [x - middle[0], y - middle[1], z - middle[2]];
      const across = -b * Math.cos(yaw) + a * Math.sin(yaw);
      const away = a * Math.cos(yaw) + b * Math.sin(yaw);
      return `${across.toFixed(1)},${(-(c * Math.cos(pitch) + away * Math.sin(pitch))).toFixed(1)}`;
    };
    const draw = () => {
      svg.replaceChildren();
      layers.forEach((layer, i) => {
        if (!on[i]) return;
        for (const line of layer.lines) {
          const polyline = document.createElementNS(SVG, "polyline");
          polyline.setAttribute("points", line.map(project).join(" "));
          polyline.setAttribute("fill", "none");
          polyline.setAttribute("stroke", layer.colour);
          polyline.setAttribute("stroke-width", "1.6");
          polyline.setAttribute("stroke-dasharray", layer.dash);
          polyline.setAttribute("vector-effect", "non-scaling-stroke");
          svg.append(polyline);
        }
      });
    };
    svg.addEventListener("pointerdown", (event) => svg.setPointerCapture(event.pointerId));
    svg.addEventListener("pointermove", (event) => {
      if (!svg.hasPointerCapture(event.pointerId)) return;
      yaw += event.movementX * 0.01;
      pitch = Math.max(-1.5, Math.min(1.5, pitch + event.movementY * 0.01));
      draw();
    });
    const views = [["from behind", 0, 0], ["from the right", Math.PI / 2, 0], ["oblique", 0.6, 0.25]];
    const buttons = views.map(([name, toYaw, toPitch]) => {
      const button = make("button", { type: "button" }, name);
      button.addEventListener("click", () => {
        [yaw, pitch] = [toYaw, toPitch];
        draw();
      });
      return button;
    });
    const toggles = checkboxes(layers.map((layer) => layer.name), (i) => on[i], (_, i, checked) => {
      on[i] = checked;
      draw();
    });
    place.append(make("div", { className: "layers" }, ...buttons), toggles, svg);
    draw();
  };
  for (const place of document.querySelectorAll(".space")) turnable(place);
}
