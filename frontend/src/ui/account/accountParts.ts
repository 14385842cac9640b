/** What only a hosted service's page shows, loaded together. */
export { AccountDialog } from './AccountDialog'
export { AccountMenu } from './AccountMenu'
export { SignInScreen } from './SignInScreen'
