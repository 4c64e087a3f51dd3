import { Kbd, UnstyledButton } from "@mantine/core";
import { useNavigate } from "@tanstack/react-router";
import { lazy, Suspense, useEffect, useRef, useState } from "react";
import { VIEWS } from "../../views";
import { SearchIcon } from "../display/icons";

const Palette = lazy(() => import("./Palette"));
const Shortcuts = lazy(() => import("./Shortcuts"));

const AFTER_G_MS = 1500;

/** Help and find: Ctrl-K opens the palette, `?` the shortcuts, `g` and a letter a page. */
export function Keyboard() {
  const [open, setOpen] = useState<"palette" | "shortcuts" | null>(null);
  const navigate = useNavigate();
  const wentAt = useRef(0);
  useEffect(() => {
    const pressed = (event: KeyboardEvent) => {
      if (event.key.toLowerCase() === "k" && (event.ctrlKey || event.metaKey)) {
        event.preventDefault();
        setOpen((now) => (now === "palette" ? null : "palette"));
        return;
      }
      if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
      if (event.key === "?") {
        event.preventDefault();
        setOpen("shortcuts");
      } else if (event.key === "/") {
        const search = document.querySelector<HTMLInputElement>("[data-testid=filter-search]");
        if (search === null) return;
        event.preventDefault();
        search.focus();
      } else if (event.key === "g") {
        // A second g within the pause is the letter of a page, not a new start.
        const view = recent(wentAt.current) ? VIEWS.find((one) => one.key === "g") : undefined;
        wentAt.current = view === undefined ? Date.now() : 0;
        if (view !== undefined) void navigate(view);
      } else if (recent(wentAt.current)) {
        wentAt.current = 0;
        const view = VIEWS.find((one) => one.key === event.key);
        if (view !== undefined) void navigate(view);
      }
    };
    document.addEventListener("keydown", pressed);
    return () => {
      document.removeEventListener("keydown", pressed);
    };
  }, [navigate]);
  const close = () => {
    setOpen(null);
  };
  return (
    <>
      <UnstyledButton
        className="frame-entry"
        data-testid="help"
        aria-keyshortcuts="?"
        aria-haspopup="dialog"
        onClick={() => {
          setOpen("shortcuts");
        }}
      >
        Help
      </UnstyledButton>
      <UnstyledButton
        className="frame-find"
        aria-label="Find"
        aria-keyshortcuts="Control+K"
        data-testid="palette-open"
        onClick={() => {
          setOpen("palette");
        }}
      >
        <SearchIcon size={13} />
        <span className="frame-find-text">Find</span>
        <Kbd size="xs">Ctrl K</Kbd>
      </UnstyledButton>
      <Suspense fallback={null}>
        {open === "palette" && <Palette onClose={close} />}
        {open === "shortcuts" && <Shortcuts onClose={close} />}
      </Suspense>
    </>
  );
}

const recent = (at: number) => Date.now() - at < AFTER_G_MS;

function isTyping(target: EventTarget | null): boolean {
  return (
    target instanceof HTMLElement &&
    (target.isContentEditable || ["INPUT", "TEXTAREA", "SELECT"].includes(target.tagName))
  );
}
