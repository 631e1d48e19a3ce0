// Paper: a canvas may come out blank, so a picture of it is printed instead; and what is folded is unfolded.

function preparePrinting(viewer, pane) {
  let picture = null, unfolded = [];
  const before = () => {
    if (picture) return;
    viewer.render();
    const src = viewer.renderer.domElement.toDataURL();
    picture = el("img", { id: "paper", alt: pane.getAttribute("aria-label"), src });
    pane.append(picture);
    unfolded = [...document.querySelectorAll("details.section:not([open])")];
    for (const part of unfolded) part.open = true;
  };
  const after = () => {
    if (picture) picture.remove();
    for (const part of unfolded) part.open = false;
    [picture, unfolded] = [null, []];
  };
  window.addEventListener("beforeprint", before);
  window.addEventListener("afterprint", after);
}
