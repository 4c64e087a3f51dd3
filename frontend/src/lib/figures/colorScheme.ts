/** Light or dark: the system decides until someone does, and a control room is dark. */
import { localStorageColorSchemeManager, useMantineColorScheme } from "@mantine/core";
import { useLayoutEffect, useRef } from "react";

const stored = localStorageColorSchemeManager();
let isOfPage = false;

/** Stores what someone decides, not what a page proposes. */
export const colorSchemeManager = {
  ...stored,
  set: (scheme: "light" | "dark" | "auto") => {
    if (!isOfPage) stored.set(scheme);
  },
};

/** Shows the page dark while it is open, unless someone has decided. */
export function useDarkByDefault(): void {
  const { setColorScheme } = useMantineColorScheme();
  const first = useRef(setColorScheme); // a new function with every scheme
  useLayoutEffect(() => {
    const propose = (scheme: "dark" | "auto") => {
      if (stored.get("auto") !== "auto") return;
      isOfPage = true;
      first.current(scheme);
      isOfPage = false;
    };
    propose("dark");
    return () => {
      propose("auto");
    };
  }, []);
}
