import { Menu, UnstyledButton } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { useLayoutEffect, useRef, useState } from "react";
import { VIEWS } from "../views";

const often = VIEWS.filter((view) => !("rare" in view));
const rare = VIEWS.filter((view) => "rare" in view);

/** The views, as many as the window has room for; the others stand behind "More". */
export function MainNav() {
  const links = useRef<HTMLDivElement>(null);
  const [room, setRoom] = useState(often.length);
  useLayoutEffect(() => {
    const row = links.current;
    if (row === null) return;
    const measure = () => {
      // What has no room is wrapped below the header, where it is cut off.
      const shown = [...row.children].filter(
        (link) => link instanceof HTMLElement && link.offsetTop < row.clientHeight,
      );
      setRoom(shown.length);
    };
    const observer = new ResizeObserver(measure);
    observer.observe(row);
    measure();
    return () => {
      observer.disconnect();
    };
  }, []);
  return (
    <nav className="frame-nav" aria-label="Main">
      <div className="frame-links" ref={links}>
        {often.map((view, place) => (
          <Link
            key={view.to}
            to={view.to}
            activeOptions={{ exact: view.to === "/", includeSearch: false }}
            style={place < room ? undefined : { visibility: "hidden" }}
          >
            {view.label}
          </Link>
        ))}
      </div>
      <Menu position="bottom-start">
        <Menu.Target>
          <UnstyledButton className="frame-more">More</UnstyledButton>
        </Menu.Target>
        <Menu.Dropdown>
          {[...often.slice(room), ...rare].map((view) => (
            <Menu.Item key={view.to} component={Link} to={view.to}>
              {view.label}
            </Menu.Item>
          ))}
        </Menu.Dropdown>
      </Menu>
    </nav>
  );
}
