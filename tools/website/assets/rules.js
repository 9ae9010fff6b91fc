// Searches and filters the index of the rules. Without it the page is the whole index.
(() => {
  const place = document.querySelector(".rule-filter");
  if (!place) return;

  const listPrograms = (cell) => {
    const names = cell.cloneNode(true);
    for (const outcome of names.querySelectorAll(".outcome")) outcome.replaceWith(" ");
    return names.textContent.match(/\w+/g) ?? [];
  };
  const families = [...document.querySelectorAll(".rule-table")].map((table) => ({
    table,
    heading: table.previousElementSibling,
    rows: [...table.querySelectorAll("tbody tr")].map((row) => {
      const [rule, finds, severity, , programs] = row.cells;
      return {
        row,
        code: rule.textContent.slice(0, 3),
        severity: severity.textContent.trim(),
        programs: listPrograms(programs),
        text: `${rule.textContent} ${finds.textContent}`.toLowerCase(),
      };
    }),
  }));
  const rows = families.flatMap((family) => family.rows);

  const count = document.createElement("output");
  const search = Object.assign(document.createElement("input"), {
    type: "search",
    placeholder: "limit, mesh, INR…",
    name: "words", // q is the site's search
  });
  const choose = (name, values) => {
    const select = Object.assign(document.createElement("select"), { name });
    select.append(new Option("all", ""), ...values.map((value) => new Option(...[value].flat())));
    return select;
  };
  const controls = {
    search,
    family: choose("family", families.map((family) => {
      const title = family.heading.firstChild.textContent.trim();
      return [title, title.slice(0, 3)];
    })),
    severity: choose("severity", ["error", "warning", "info"]),
    program: choose("program", [...new Set(rows.flatMap((rule) => rule.programs))].sort()),
  };
  for (const [name, control] of Object.entries(controls)) {
    const label = document.createElement("label");
    label.append(name, control);
    place.append(label);
  }
  place.append(count);
  place.hidden = false;

  const filter = () => {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const { family, severity, program } = controls;
    let shown = 0;
    for (const { table, heading, rows } of families) {
      let left = 0;
      for (const rule of rows) {
        const fits =
          words.every((word) => rule.text.includes(word)) &&
          (!family.value || rule.code === family.value) &&
          (!severity.value || rule.severity === severity.value) &&
          (!program.value || rule.programs.includes(program.value));
        rule.row.hidden = !fits;
        left += fits;
      }
      table.hidden = heading.hidden = !left;
      shown += left;
    }
    count.value = shown === rows.length ? `${shown} rules` : `${shown} of ${rows.length} rules`;
    const query = new URLSearchParams(location.search);
    for (const control of Object.values(controls)) {
      if (control.value) query.set(control.name, control.value);
      else query.delete(control.name);
    }
    history.replaceState(null, "", `${location.pathname}${query.size ? `?${query}` : ""}${location.hash}`);
  };

  // An address with ?program=gazebo opens the index with that filter.
  const asked = new URLSearchParams(location.search);
  for (const control of Object.values(controls)) control.value = asked.get(control.name) ?? "";
  for (const control of Object.values(controls)) control.addEventListener("input", filter);
  filter();
})();
