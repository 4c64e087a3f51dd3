import { AppShell, Group, Text } from "@mantine/core";
import { Link, Outlet } from "@tanstack/react-router";
import { ColorSchemeToggle } from "./ColorSchemeToggle";
import { Health } from "./Health";

/** Header with navigation around every page. */
export function AppFrame() {
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
            <Link to="/" activeOptions={{ exact: true, includeSearch: false }}>
              Campaign
            </Link>
            <Link to="/compare" activeOptions={{ includeSearch: false }}>
              Compare
            </Link>
            <Link to="/model-structures" activeOptions={{ includeSearch: false }}>
              Structures
            </Link>
            <Link to="/flutter" activeOptions={{ includeSearch: false }}>
              Flutter
            </Link>
            <Link to="/jobs" activeOptions={{ includeSearch: false }}>
              Jobs
            </Link>
            <Link to="/excitation" activeOptions={{ includeSearch: false }}>
              Excitation
            </Link>
            <Link to="/aircraft" activeOptions={{ includeSearch: false }}>
              Aircraft
            </Link>
          </nav>
          <Group ml="auto" gap="md" wrap="nowrap">
            <Health />
            <ColorSchemeToggle />
          </Group>
        </div>
      </AppShell.Header>
      <AppShell.Main>
        <div className="page" id="content" tabIndex={-1}>
          <Outlet />
        </div>
      </AppShell.Main>
    </AppShell>
  );
}
