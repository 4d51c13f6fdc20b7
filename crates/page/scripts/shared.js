// Gives the solver, which several pages share, to a page.
document.getElementById("live-solver").textContent = "{{solver}}";
