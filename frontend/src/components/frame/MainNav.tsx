import { Menu, UnstyledButton } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link, useLocation } from "@tanstack/react-router";
import { queueQuery } from "../../api/queries";
import { isCurrent, MENU, SIDE_MENU, type MenuPage } from "../../views";

/** The menu in the order of the work; an entry with several pages opens a dropdown. */
export function MainNav() {
  const { pathname, hash } = useLocation();
  return (
    <nav className="frame-nav" aria-label="Main">
      {MENU.map(({ label, pages }) =>
        pages.length === 1 ? (
          <PageLink key={label} page={pages[0]} label={label} />
        ) : (
          <Menu key={label} position="bottom-start" offset={4}>
            <Menu.Target>
              <UnstyledButton
                className="frame-entry"
                data-current={pages.some((page) => isCurrent(page, pathname, hash)) || undefined}
                onKeyDown={(event) => {
                  if (event.key !== "ArrowDown" || isOpen(event.currentTarget)) return;
                  event.preventDefault();
                  event.currentTarget.click();
                }}
              >
                {label}
                <span className="frame-caret" aria-hidden="true" />
              </UnstyledButton>
            </Menu.Target>
            <Menu.Dropdown>
              {pages.map((page) => (
                <Menu.Item
                  key={page.label}
                  component={Link}
                  to={page.to}
                  hash={page.hash}
                  className="frame-item"
                  activeProps={NOT_MARKED}
                  {...mark(page, pathname, hash)}
                >
                  {page.label}
                </Menu.Item>
              ))}
            </Menu.Dropdown>
          </Menu>
        ),
      )}
    </nav>
  );
}

/** Links at the right of the header; that of the jobs while some are queued or running. */
export function SideNav() {
  const { pathname } = useLocation();
  const { data } = useQuery(queueQuery);
  const isBusy = (data?.states.queued ?? 0) + (data?.states.running ?? 0) > 0;
  return (
    <nav className="frame-nav" aria-label="Workbench">
      {SIDE_MENU.filter(
        (page) => page.to !== "/jobs" || isBusy || page.at?.test(pathname) === true,
      ).map((page) => (
        <PageLink key={page.to} page={page} label={page.label} />
      ))}
    </nav>
  );
}

function PageLink({ page, label }: { page: MenuPage; label: string }) {
  const { pathname, hash } = useLocation();
  return (
    <Link
      to={page.to}
      className="frame-entry"
      activeProps={NOT_MARKED}
      {...mark(page, pathname, hash)}
    >
      {label}
    </Link>
  );
}

const isOpen = (target: HTMLElement) => target.getAttribute("aria-expanded") === "true";

/** The router marks links by their path alone; the menu also counts the records of a page. */
const NOT_MARKED = { "aria-current": undefined, className: "" };

const mark = (page: MenuPage, pathname: string, hash: string) =>
  isCurrent(page, pathname, hash)
    ? { "aria-current": "page" as const, "data-current": true }
    : { "aria-current": undefined, "data-current": undefined };
