// Colours that people with any colour vision can distinguish: blue and sand for the bodies, as in all pictures
// (`crates/colltrans-picture/src/style.rs`). Orange, green and magenta differ from these and from each other in
// lightness too.

export interface Palette {
  dark: boolean;
  moving: string;
  fixed: string;
  edge: string;
  movingMark: string;
  fixedMark: string;
  normal: string;
  plane: string;
  way: string;
  grid: string;
  text: string;
}

const LIGHT: Palette = {
  dark: false,
  moving: "#6f97d6",
  fixed: "#d9cbb0",
  edge: "#1d2733",
  movingMark: "#0b57d0",
  fixedMark: "#c2600f",
  normal: "#b01657",
  plane: "#0a8a68",
  way: "#1d2733",
  grid: "#c9ced6",
  text: "#1d2733",
};

const DARK: Palette = {
  dark: true,
  moving: "#5f8fe0",
  fixed: "#b7a583",
  edge: "#0b0e13",
  movingMark: "#a9c9ff",
  fixedMark: "#ff9d45",
  normal: "#ff6fa8",
  plane: "#35d6a6",
  way: "#e6ebf2",
  grid: "#39414d",
  text: "#e6ebf2",
};

const asked = matchMedia("(prefers-color-scheme: dark)");

export function palette(): Palette {
  const chosen = document.documentElement.dataset.theme;
  return (chosen ? chosen === "dark" : asked.matches) ? DARK : LIGHT;
}

export function onChange(f: () => void) {
  asked.addEventListener("change", f);
}
