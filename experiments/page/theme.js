"use strict";
// Light or dark: as the system says, until the reader chooses. Loaded before the page is drawn, so that it does not flash.

const theme = {
  listeners: [],
  printing: false,
  system: matchMedia("(prefers-color-scheme: dark)"),

  get chosen() {
    try {
      return localStorage.getItem("lampyris-theme");
    } catch {
      return document.documentElement.dataset.theme; // storage is refused: the choice lasts as long as the page
    }
  },

  get dark() {
    return !theme.printing && (theme.chosen ? theme.chosen === "dark" : theme.system.matches);
  },

  apply() {
    document.documentElement.dataset.theme = theme.dark ? "dark" : "light";
    theme.listeners.forEach((listener) => listener());
  },

  toggle() {
    const next = theme.dark ? "light" : "dark";
    document.documentElement.dataset.theme = next;
    try {
      localStorage.setItem("lampyris-theme", next);
    } catch {
      // as above
    }
    theme.apply();
  },
};

theme.system.addEventListener("change", theme.apply);
theme.apply();
