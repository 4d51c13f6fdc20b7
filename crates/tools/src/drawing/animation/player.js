// Plays the film that each element of class `player` has with it.
(() => {
  const SPEEDS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
  // How long a film lasts at the speeds that are offered, and at the first one, in seconds.
  const LASTS = [0.5, 120];
  const LASTS_BEST = 4;

  function play(player) {
    const find = (selector) => player.querySelector(selector);
    const film = JSON.parse(find(".film").textContent);
    const levels = decode(film.data);
    const last = film.moments - 1;
    const duration = film.stop - film.start;
    const scrub = find(".time");
    const clock = find(".clock");
    const speed = find(".speed");
    let playing = false;
    let moment = 0;
    let elapsed = 0;
    let before = null;

    const value = (channel) => {
      const [low, high] = film.scales[channel];
      return low + (high - low) * (levels[channel * film.moments + moment] / 65535);
    };
    const time = () => (moment === last ? film.stop : film.start + moment * film.step);

    // The channels: attachments, lengths, points, forces, torques, readings.
    const lengthsAt = 3 * film.attachments;
    const pointsAt = lengthsAt + film.lengths;
    const forcesAt = pointsAt + 4 * film.points.length;
    const torquesAt = forcesAt + 2 * film.forces.length;
    const readingsAt = torquesAt + film.torques.length;

    const parts = new Parts(find(".stage"), film);
    const arrows = ["velocity", "acceleration"].map((kind) =>
      film.points.map(() => addTo(find(`.arrows.${kind}`), "path")),
    );
    const [forces, torques] = [film.forces, film.torques].map((places) =>
      places.map(({ kind }) => {
        const path = addTo(find(".arrows.force"), "path");
        path.setAttribute("class", kind);
        return path;
      }),
    );
    const readings = film.readings.map((reading, index) => {
      const [low, high] = film.scales[readingsAt + index];
      const most = Math.max(Math.abs(low), Math.abs(high));
      // What is smaller than this is rounding.
      const size = most < 1e-9 ? 1 : most;
      const decimals = Math.min(9, Math.max(0, 3 - Math.floor(Math.log10(size))));
      const row = document.createElement("div");
      const name = row.appendChild(document.createElement("dt"));
      const number = row.appendChild(document.createElement("dd"));
      name.textContent = reading.name;
      find(".readings").append(row);
      return (now) => {
        // No negative zero.
        const text = now.toFixed(decimals).replace(/^-(0\.?0*)$/, "$1");
        number.textContent = `${text} ${reading.unit}`;
      };
    });
    const digits = Math.max(0, Math.min(6, Math.ceil(-Math.log10(film.step || 1)) + 1));

    function draw() {
      const placed = (attachment) => [0, 1, 2].map((part) => value(3 * attachment + part));
      parts.draw(placed, (length) => value(lengthsAt + length));
      film.points.forEach((point, index) => {
        const from = parts.outside(point.attachment, point.at);
        arrows.forEach((paths, kind) => {
          const channel = pointsAt + 4 * index + 2 * kind;
          paths[index].setAttribute("d", arrow(from, value(channel), value(channel + 1)));
        });
      });
      film.forces.forEach((force, index) => {
        const channel = forcesAt + 2 * index;
        const from = parts.outside(force.attachment, force.at);
        forces[index].setAttribute("d", arrow(from, value(channel), value(channel + 1)));
      });
      film.torques.forEach((torque, index) => {
        const center = parts.outside(torque.attachment, torque.at);
        torques[index].setAttribute("d", turn(center, value(torquesAt + index)));
      });
      readings.forEach((show, index) => show(value(readingsAt + index)));
      const now = `${time().toFixed(digits)} s`;
      clock.textContent = now;
      scrub.value = moment;
      scrub.setAttribute("aria-valuetext", now);
    }

    function go(to) {
      moment = Math.min(last, Math.max(0, to));
      elapsed = time() - film.start;
      draw();
    }

    function set(now) {
      playing = now && last > 0;
      before = null;
      player.classList.toggle("playing", playing);
      find(".play").setAttribute("aria-label", playing ? "Pause" : "Play");
      if (playing) {
        requestAnimationFrame(tick);
      }
    }

    function tick(now) {
      if (!playing) {
        return;
      }
      if (before !== null) {
        elapsed = (elapsed + Number(speed.value) * ((now - before) / 1000)) % duration;
        const next = Math.min(last, Math.floor(elapsed / film.step + 1e-6));
        if (next !== moment) {
          moment = next;
          draw();
        }
      }
      before = now;
      requestAnimationFrame(tick);
    }

    function show(box) {
      player.classList.toggle(`show-${box.value}`, box.checked);
      // Only texts on the page have a width.
      if (box.value === "names" && box.checked) {
        fit();
      }
    }

    const offered = SPEEDS.filter((s) => s === 1 || (duration / s >= LASTS[0] && duration / s <= LASTS[1]));
    const off = (s) => Math.abs(Math.log(duration / s / LASTS_BEST));
    const best = offered.reduce((a, b) => (off(b) < off(a) ? b : a));
    for (const s of offered) {
      speed.add(new Option(s === 1 ? "real time" : s < 1 ? `1/${Math.round(1 / s)}` : `×${s}`, s, s === best, s === best));
    }
    const switches = [...player.querySelectorAll(".show")];
    for (const box of switches) {
      const arrows = { velocity: film.points, acceleration: film.points, force: [...film.forces, ...film.torques] };
      if (arrows[box.value]?.length === 0) {
        box.parentElement.remove();
        continue;
      }
      // How long the longest arrows are that there are.
      const units = { velocity: ["m/s"], acceleration: ["", "m/s²"], force: ["", "", "N", "N m"] }[box.value] ?? [];
      const most = units.map((unit, kind) => [film.most[kind], unit]).filter(([size, unit]) => unit && size > 0);
      if (most.length > 0) {
        const sizes = most.map(([size, unit]) => `${Number(size.toPrecision(3))} ${unit}`);
        box.nextElementSibling.append(`, up to ${sizes.join(", ")}`);
      }
      box.addEventListener("change", () => show(box));
      show(box);
    }
    find(".play").addEventListener("click", () => set(!playing));
    scrub.addEventListener("input", () => {
      set(false);
      go(Number(scrub.value));
    });
    const step = (by) => () => {
      set(false);
      go(moment + by);
    };
    const toggle = (name) => () => switches.find((box) => box.value === name && box.isConnected)?.click();
    const keys = {
      " ": () => set(!playing),
      ArrowLeft: step(-1),
      ArrowRight: step(1),
      Home: step(-Infinity),
      End: step(Infinity),
      v: toggle("velocity"),
      a: toggle("acceleration"),
      f: toggle("force"),
      n: toggle("names"),
    };
    player.classList.toggle("still", last < 1);
    function fit() {
      parts.fit();
      draw();
    }
    addEventListener("resize", fit);
    fit();
    return { start: () => set(true), key: (key) => keys[key] };
  }

  // Base64 of numbers of two bytes each, the low one first.
  function decode(data) {
    const text = atob(data);
    const levels = new Uint16Array(text.length / 2);
    for (let index = 0; index < levels.length; index += 1) {
      levels[index] = text.charCodeAt(2 * index) + 256 * text.charCodeAt(2 * index + 1);
    }
    return levels;
  }

  const elements = [...document.querySelectorAll(".player")];
  const players = elements.map(play);
  // On a page with more to read, keys that are not meant for a player scroll.
  const alone = !document.querySelector("main h2");
  document.addEventListener("keydown", (event) => {
    const { target, key } = event;
    const own = target.matches("select") || (target.matches("button, input[type=checkbox]") && key === " ");
    const meant = elements.indexOf(target.closest(".player"));
    const act = players[meant < 0 && alone ? 0 : meant]?.key(key);
    if (act && !own && !event.ctrlKey && !event.metaKey && !event.altKey) {
      event.preventDefault();
      act();
    }
  });
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) {
    players.forEach((player) => player.start());
  }
})();
