import { AppShell, Group, Menu, Text, UnstyledButton } from "@mantine/core";
import { Link, Outlet } from "@tanstack/react-router";
import { useLive } from "../api/live";
import { VIEWS } from "../views";
import { AnalystMenu } from "./AnalystMenu";
import { ColorSchemeToggle } from "./ColorSchemeToggle";
import { Health, LostConnection } from "./Health";
import { Keyboard } from "./Keyboard";
import { NoticeBar } from "./NoticeBar";
import { Notifications } from "./Notifications";

const often = VIEWS.filter((view) => !("rare" in view));
/** As many stand in the narrowest header; the rest is under "More" too (see styles.css). */
const FIRST = 6;
const rare = VIEWS.filter((view) => "rare" in view);

/** Header with navigation around every page. */
export function AppFrame() {
  useLive();
  return (
    <AppShell header={{ height: 48 }}>
      <a className="skip" href="#content">
        Skip to content
      </a>
      <AppShell.Header>
        <div className="frame-header">
          <Text fw={700} size="lg" lts="-0.01em">
            flexsid
          </Text>
          <nav className="frame-nav" aria-label="Main">
            {often.map((view) => (
              <Link
                key={view.to}
                to={view.to}
                activeOptions={{ exact: view.to === "/", includeSearch: false }}
              >
                {view.label}
              </Link>
            ))}
            <Menu position="bottom-start">
              <Menu.Target>
                <UnstyledButton className="frame-more">More</UnstyledButton>
              </Menu.Target>
              <Menu.Dropdown>
                {[...often.slice(FIRST), ...rare].map((view) => (
                  <Menu.Item key={view.to} component={Link} to={view.to}>
                    {view.label}
                  </Menu.Item>
                ))}
              </Menu.Dropdown>
            </Menu>
          </nav>
          <Group ml="auto" gap="md" wrap="nowrap">
            <Keyboard />
            <Notifications />
            <AnalystMenu />
            <Health />
            <ColorSchemeToggle />
          </Group>
        </div>
      </AppShell.Header>
      <AppShell.Main>
        <div className="page" id="content" tabIndex={-1}>
          <LostConnection />
          <Outlet />
        </div>
      </AppShell.Main>
      <NoticeBar />
    </AppShell>
  );
}
